"""The Princeton benchmark from its folder to its printed table, on a folder of small made-up models."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from bench.__main__ import main
from bench.commands.compare import paired_difference
from bench.errors import BenchmarkError
from bench.pool import evaluate_models
from bench.princeton.dataset import read_models
from bench.princeton.evaluation import ModelResult, Segmenter, evaluate_model
from bench.princeton.metrics import METRICS
from bench.princeton.report import render
from bench.princeton.results import load_results, save_results
from helpers.strips import EvenSegmenter, cut_at, strip

COLUMNS = 12
# Two categories of different size, so that the mean over models and that over categories differ.
CATEGORIES = {1: "Rod", 3: "Rod", 21: "Slat"}
PEOPLE = (cut_at(COLUMNS, 4, 8), cut_at(COLUMNS, 4, 9), cut_at(COLUMNS, 6))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Three equal strips, which three people cut into 3, 3 and 2 parts."""
    data = tmp_path / "data"
    (data / "off").mkdir(parents=True)
    vertices, faces = strip(COLUMNS)
    lines = ["OFF", f"{len(vertices)} {len(faces)} 0", *(f"{x} {y} {z}" for x, y, z in vertices)]
    lines += [f"3 {a} {b} {c}" for a, b, c in faces]
    for number in CATEGORIES:
        (data / "off" / f"{number}.off").write_text("\n".join(lines) + "\n")
        people = data / "seg" / "Benchmark" / str(number)
        people.mkdir(parents=True)
        for person, labels in enumerate(PEOPLE):
            np.savetxt(people / f"{number}_{person}.seg", labels, fmt="%d")
    rows = [f"{number}\t{category}\t3" for number, category in CATEGORIES.items()]
    (data / "segments.tsv").write_text("\n".join(["model\tcategory\tsegments", *rows]) + "\n")
    return data


def evaluate_all(folder: Path, segmenter: Segmenter, seeds: tuple[int, ...] = (0,)) -> list[ModelResult]:
    return [evaluate_model(model, segmenter, seeds, "given") for model in read_models(folder)]


def row_of(text: str, name: str) -> list[str]:
    return next(line for line in text.splitlines() if line.startswith(name)).removeprefix(name).split()


def test_a_model_scores_the_mean_over_its_people(folder: Path) -> None:
    result = evaluate_all(folder, EvenSegmenter())[0]
    # Cuts at 4 and 8 against 4 and 8; against 4 and 9, one column off both ways; against 6, where each half misses
    # two columns beyond its best part and the part in the middle has two in the other half.
    assert (result.people, result.runs[0].segments, result.runs[0].fell_short) == (3, 3, False)
    assert result.scores.missing_rate == pytest.approx((0 + 1 / 12 + 4 / 12) / 3)
    assert result.scores.hamming == pytest.approx((0 + 1 / 12 + (4 + 2) / 24) / 3)


def test_a_model_scores_the_mean_over_its_seeds(folder: Path) -> None:
    both = evaluate_all(folder, EvenSegmenter(), (0, 1))[0]
    apart = [evaluate_all(folder, EvenSegmenter(), (seed,))[0].scores.one_minus_rand for seed in (0, 1)]
    assert [run.seed for run in both.runs] == [0, 1]
    assert apart[0] != apart[1]
    assert both.scores.one_minus_rand == pytest.approx(np.mean(apart))


def test_a_short_hierarchy_gives_all_that_it_has_and_is_counted(folder: Path) -> None:
    results = evaluate_all(folder, EvenSegmenter(max_segments=2))
    assert [run.segments for result in results for run in result.runs] == [2, 2, 2]
    assert "ends earlier: 3 of 3" in render(results, "given")


def test_the_automatic_number_is_the_segmenters_own(folder: Path) -> None:
    results = [evaluate_model(model, EvenSegmenter(), (0,), "automatic") for model in read_models(folder)]
    text = render(results, "automatic")
    assert "mean 2.0 (given: 3.0); within 2 of the given one in 3 of 3" in text


def test_every_model_has_the_same_weight_and_categories_are_shown_apart(folder: Path) -> None:
    people = folder / "seg" / "Benchmark" / "21"
    np.savetxt(people / "21_0.seg", PEOPLE[2], fmt="%d")
    results = evaluate_all(folder, EvenSegmenter())
    by_model = [result.scores.one_minus_rand for result in results]
    text = render(results, "given")
    column = 1 + METRICS.index("one_minus_rand")
    assert row_of(text, "All models")[column] == f"{np.mean(by_model):.4f}"
    assert row_of(text, "Mean of categories")[column] == f"{(by_model[0] + by_model[2]) / 2:.4f}"
    assert row_of(text, "Slat")[column] == f"{by_model[2]:.4f}"


def test_the_row_of_the_people_compares_each_with_all_others(folder: Path) -> None:
    result = evaluate_all(folder, EvenSegmenter())[0]
    pairs = [1 / 12, (4 + 2) / 24, (5 + 2) / 24]
    assert result.people_scores.hamming == pytest.approx(np.mean(pairs))
    assert f"{np.mean(pairs):.4f}" in row_of(render([result], "given"), "People, leave-one-out")


def test_comparisons_without_a_cut_are_counted(folder: Path) -> None:
    results = evaluate_all(folder, EvenSegmenter(max_segments=1))
    text = render(results, "given")
    assert all(math.isnan(result.scores.cut_discrepancy) for result in results)
    assert "9 of 9 comparisons are left out of it, and with them 3 of 3 models" in text
    assert row_of(text, "All models")[1] == "-"


def test_processes_give_the_same_results_in_the_same_order(folder: Path) -> None:
    models = read_models(folder)
    results = evaluate_models(models, EvenSegmenter(), (0, 1), "given", jobs=2)
    alone = evaluate_all(folder, EvenSegmenter(), (0, 1))
    assert [(r.model, r.scores, r.people_scores) for r in results] == [
        (r.model, r.scores, r.people_scores) for r in alone
    ]


def test_a_failing_model_stops_the_benchmark_and_is_named(folder: Path) -> None:
    with pytest.raises(BenchmarkError, match="Model 1: the method gave up"):
        evaluate_models(read_models(folder)[:1], EvenSegmenter(broken=True), (0,), "given", jobs=1)


def test_a_limit_takes_models_from_the_whole_list(folder: Path) -> None:
    assert [model.number for model in read_models(folder, 2)] == [1, 3]
    assert [model.number for model in read_models(folder, 99)] == [1, 3, 21]
    rows = "".join(f"{number}\tAny\t2\n" for number in range(1, 11))
    (folder / "segments.tsv").write_text("model\tcategory\tsegments\n" + rows)
    assert [model.number for model in read_models(folder, 5)] == [1, 3, 5, 7, 9]


def test_saved_results_come_back_with_undefined_scores(folder: Path, tmp_path: Path) -> None:
    results = evaluate_all(folder, EvenSegmenter(max_segments=1))
    save_results(tmp_path / "a.json", results, "given", {"seedless": 1})
    loaded = load_results(tmp_path / "a.json")
    assert "NaN" not in (tmp_path / "a.json").read_text()
    assert loaded.scores.keys() == set(CATEGORIES)
    assert math.isnan(loaded.scores[1].cut_discrepancy)
    assert loaded.scores[3].gce == results[1].scores.gce


def test_the_paired_difference_has_the_standard_error_of_the_differences() -> None:
    paired = paired_difference([0.1, 0.2, 0.3, math.nan], [0.2, 0.2, 0.6, 0.5])
    assert (paired.models, paired.better, paired.worse) == (3, 0, 2)
    assert paired.difference == pytest.approx(0.4 / 3)
    assert paired.standard_error == pytest.approx(np.std([0.1, 0, 0.3], ddof=1) / math.sqrt(3))


def test_compare_prints_the_difference_of_two_files(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    paths = [tmp_path / "a.json", tmp_path / "b.json"]
    for path, seed in zip(paths, (0, 1), strict=True):
        save_results(path, evaluate_all(folder, EvenSegmenter(), (seed,)), "given", {})
    a, b = (load_results(path).scores for path in paths)
    assert main(["compare", *map(str, paths)]) == 0
    difference = np.mean([b[m].one_minus_rand - a[m].one_minus_rand for m in CATEGORIES])
    assert row_of(capsys.readouterr().out, "one_minus_rand")[3] == f"{difference:.4f}"


def test_the_command_judges_cleave_and_saves_what_it_prints(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    output = tmp_path / "results.json"
    options = ["--data", str(folder), "--limit", "2", "--seeds", "0,1", "--parameters", "max_segments=4"]
    assert main(["princeton", *options, "--output", str(output)]) == 0
    printed = row_of(capsys.readouterr().out, "All models")
    document = json.loads(output.read_text())
    assert (document["seeds"], document["parameters"]) == ([0, 1], {"max_segments": 4})
    assert [[run["segments"] for run in model["runs"]] for model in document["models"]] == [[3, 3], [3, 3]]
    assert printed[2] == f"{document['scores']['hamming']:.4f}"


def test_the_list_names_every_command_with_its_summary(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == 0
    listed = capsys.readouterr().out
    assert "princeton" in listed
    assert "compare" in listed
    assert "Quality on the Princeton Segmentation Benchmark" in listed


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["chess"], "no command 'chess'"),
        (["princeton", "--data", "nowhere"], "nowhere is not the folder"),
        (["princeton", "--data", "nowhere", "--parameters", "seed=1"], "--seeds"),
        (["princeton", "--data", "nowhere", "--parameters", "seeed=1"], "seeed"),
        (["princeton", "--data", "nowhere", "--parameters", "max_segments=0"], "max_segments must be"),
        (["princeton", "--data", "nowhere", "--jobs", "0"], "at least 1"),
        (["princeton", "--data", "nowhere", "--output", "no/such/folder.json"], "create it first"),
        (["compare", "nowhere.json", "nowhere.json"], "nowhere.json cannot be read"),
    ],
)
def test_what_cannot_be_run_is_one_sentence(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1


def test_files_that_do_not_fit_are_named(folder: Path) -> None:
    model = read_models(folder)[0]
    path = model.people_folder / "1_0.seg"
    for content, message in [("0\n1\n", "each of 24 faces, not 2"), ("a\n", "not a list of integers"), ("", "not 0")]:
        path.write_text(content)
        with pytest.raises(BenchmarkError, match=message):
            model.read_people(2 * COLUMNS)
    model.mesh_path.unlink()
    with pytest.raises(BenchmarkError, match="Model 1 cannot be read"):
        model.read_mesh()
    (folder / "segments.tsv").write_text("model\tkind\n1\tRod\n")
    with pytest.raises(BenchmarkError, match="columns model, category, segments"):
        read_models(folder)


def test_results_of_another_kind_are_refused(tmp_path: Path) -> None:
    for content in ("[]", json.dumps({"format": "other"}), "{"):
        (tmp_path / "x.json").write_text(content)
        with pytest.raises(BenchmarkError, match="princeton --output"):
            load_results(tmp_path / "x.json")
