"""The evaluation of models and its report, on a folder of small strips."""

import math
from pathlib import Path

import numpy as np
import pytest

from bench.errors import BenchmarkError
from bench.princeton.dataset import read_models
from bench.princeton.evaluation import ModelResult, Segmenter, evaluate_model
from bench.princeton.metrics import METRICS
from bench.princeton.parallel import evaluate_models
from bench.princeton.report import render
from helpers.bench.strips import STRIP_PEOPLE, EvenSegmenter


def evaluate_all(folder: Path, segmenter: Segmenter, seeds: tuple[int, ...] = (0,)) -> list[ModelResult]:
    return [evaluate_model(model, segmenter, seeds, "given") for model in read_models(folder)]


def row_of(text: str, name: str) -> list[str]:
    return next(line for line in text.splitlines() if line.startswith(name)).removeprefix(name).split()


def test_the_score_of_a_model_is_the_mean_over_its_people(strips: Path) -> None:
    result = evaluate_all(strips, EvenSegmenter())[0]
    # Cuts at 4 and 8 against 4 and 8; against 4 and 9, one column off in both directions; against 6: each half has two
    # columns outside its best part, and the part in the middle has two in the other half.
    assert (result.people, result.runs[0].segments, result.runs[0].fell_short) == (3, 3, False)
    assert result.scores.missing_rate == pytest.approx((0 + 1 / 12 + 4 / 12) / 3)
    assert result.scores.hamming == pytest.approx((0 + 1 / 12 + (4 + 2) / 24) / 3)


def test_the_score_of_a_model_is_the_mean_over_its_seeds(strips: Path) -> None:
    both = evaluate_all(strips, EvenSegmenter(), (0, 1))[0]
    each = [evaluate_all(strips, EvenSegmenter(), (seed,))[0].scores.one_minus_rand for seed in (0, 1)]
    assert [run.seed for run in both.runs] == [0, 1]
    assert each[0] != each[1]
    assert both.scores.one_minus_rand == pytest.approx(np.mean(each))


def test_a_short_hierarchy_is_used_to_its_end_and_counted(strips: Path) -> None:
    results = evaluate_all(strips, EvenSegmenter(max_segments=2))
    assert [run.segments for result in results for run in result.runs] == [2, 2, 2]
    assert "ends earlier: 3 of 3" in render(results, "given")


def test_the_automatic_number_is_that_of_the_segmenter(strips: Path) -> None:
    results = [evaluate_model(model, EvenSegmenter(), (0,), "automatic") for model in read_models(strips)]
    text = render(results, "automatic")
    assert "mean 2.0 (given: 3.0); within 2 of the given one in 3 of 3" in text


def test_every_model_has_the_same_weight_and_categories_have_their_own_rows(strips: Path) -> None:
    people = strips / "seg" / "Benchmark" / "21"
    np.savetxt(people / "21_0.seg", STRIP_PEOPLE[2], fmt="%d")
    results = evaluate_all(strips, EvenSegmenter())
    by_model = [result.scores.one_minus_rand for result in results]
    text = render(results, "given")
    column = 1 + METRICS.index("one_minus_rand")
    assert row_of(text, "All models")[column] == f"{np.mean(by_model):.4f}"
    assert row_of(text, "Mean of categories")[column] == f"{(by_model[0] + by_model[2]) / 2:.4f}"
    assert row_of(text, "Slat")[column] == f"{by_model[2]:.4f}"


def test_the_row_of_the_people_compares_each_with_all_others(strips: Path) -> None:
    result = evaluate_all(strips, EvenSegmenter())[0]
    pairs = [1 / 12, (4 + 2) / 24, (5 + 2) / 24]
    assert result.people_scores.hamming == pytest.approx(np.mean(pairs))
    assert f"{np.mean(pairs):.4f}" in row_of(render([result], "given"), "People, leave-one-out")


def test_comparisons_without_a_cut_are_counted(strips: Path) -> None:
    results = evaluate_all(strips, EvenSegmenter(max_segments=1))
    text = render(results, "given")
    assert all(math.isnan(result.scores.cut_discrepancy) for result in results)
    assert "9 of 9 comparisons are left out of it, and with them 3 of 3 models" in text
    assert row_of(text, "All models")[1] == "-"


def test_processes_return_the_same_results_in_the_same_order(strips: Path) -> None:
    models = read_models(strips)
    results = evaluate_models(models, EvenSegmenter(), (0, 1), "given", jobs=2)
    expected = evaluate_all(strips, EvenSegmenter(), (0, 1))
    assert [(r.model, r.scores, r.people_scores) for r in results] == [
        (r.model, r.scores, r.people_scores) for r in expected
    ]


def test_a_failure_stops_the_benchmark_and_the_error_names_the_model(strips: Path) -> None:
    with pytest.raises(BenchmarkError, match="Model 1: the method gave up"):
        evaluate_models(read_models(strips)[:1], EvenSegmenter(broken=True), (0,), "given", jobs=1)
