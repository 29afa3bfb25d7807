"""The paper command, from its folder to its files, on two shapes with known parts."""

from pathlib import Path

import pytest

from bench.__main__ import main
from bench.paper.items import ITEMS
from bench.princeton.results import load_results
from helpers.bench.paper_models import SHAPES, write_benchmark

VARIANTS = {"inverse_power", "split_bregman", "fiedler", "inverse_power_adjacency", "fiedler_adjacency"}
PNG = b"\x89PNG\r\n\x1a\n"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return write_benchmark(tmp_path / "data")


def test_the_command_makes_every_table_and_figure(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    output, cache = tmp_path / "output", tmp_path / "cache"
    options = ["--data", str(folder), "--peers", "kmeans", "--output", str(output), "--cache", str(cache)]
    assert main(["paper", *options]) == 0
    texts = {path.stem: path.read_text(encoding="utf-8") for path in output.glob("*.txt")}
    assert capsys.readouterr().out == "".join(f"{texts[name]}\n" for name in ITEMS)
    assert {path.stem for path in output.glob("*.png")} >= {"figure4", "figure8", "figure5"}
    assert all(path.read_bytes().startswith(PNG) for path in output.glob("*.png"))
    assert {path.stem for path in output.glob("*.json")} == VARIANTS | {"cleave", "kmeans"}
    assert all(load_results(path).scores.keys() == set(SHAPES) for path in output.glob("*.json"))
    # No method failed, and there is a file for every method and model.
    assert "failed on model" not in texts["figure4"] + texts["figure8"]
    assert {path.relative_to(cache).as_posix() for path in cache.rglob("*.npz")} == {
        f"{method}/{model}.npz" for method in VARIANTS | {"cleave", "kmeans"} for model in SHAPES
    }


def test_only_the_requested_items_are_made(folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    output = tmp_path / "output"
    options = ["--data", str(folder), "--limit", "1", "--only", "figure9", "--output", str(output)]
    assert main(["paper", *options]) == 0
    assert capsys.readouterr().out.startswith(ITEMS["figure9"].title)
    assert {path.name for path in output.iterdir()} - {"figure9.png"} == {
        "figure9.txt",
        "fiedler.json",
        "inverse_power.json",
    }


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--data", "nowhere"], "nowhere is not the folder"),
        (["--data", "{data}", "--jobs", "0"], "at least 1"),
        (["--data", "{data}", "--limit", "0"], "at least 1 model"),
        (["--data", "{data}", "--output", "{data}/no/such"], "cannot be made"),
        (["--data", "{data}", "--cache", "{data}/segments.tsv"], "cannot be made"),
    ],
)
def test_an_error_is_one_sentence(
    folder: Path, arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["paper", *(argument.format(data=folder) for argument in arguments)]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1


def test_figure_5_needs_its_model(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "segments.tsv").write_text("model\tcategory\tsegments\n1\tHuman\t7\n")
    assert main(["paper", "--data", str(folder), "--only", "figure5"]) == 2
    assert "Figure 5 shows model 341" in capsys.readouterr().err


@pytest.mark.parametrize("option", ["--only", "--peers"])
def test_an_unknown_name_is_rejected(option: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["paper", "--data", "nowhere", option, "kmeans,figure4"])
    assert "is not one of" in capsys.readouterr().err
