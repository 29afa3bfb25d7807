"""The assets command, from its folder to its printed table."""

import json
from pathlib import Path

import pytest

from bench.__main__ import main
from segcore.learned.models import learned_models


def test_the_command_prints_saves_and_draws_the_same_results(
    assets: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    output, sheets = tmp_path / "results.json", tmp_path / "sheets"
    options = ["--data", str(assets), "--seed", "2", "--parameters", "max_segments=3", "clusters=300"]
    assert main(["assets", *options, "--output", str(output), "--sheet", str(sheets)]) == 0
    printed = capsys.readouterr().out
    document = json.loads(output.read_text())
    assert (document["seed"], document["parameters"]) == (2, {"max_segments": 3, "clusters": 300})
    assert [f"{one['collection']}/{one['name']}" for one in document["models"]] == ["props/crate", "robots/bell"]
    row = next(line for line in printed.splitlines() if line.startswith("mean over sets"))
    assert f"{document['mean']['given']:.4f}" == row.removeprefix("mean over sets").split()[4]
    bell = document["models"][1]
    assert bell["given"]["segments"] == 3
    assert bell["given"]["one_minus_rand"] < 0.05
    assert bell["given"]["iou"] > 0.9
    assert {path.name for path in sheets.iterdir()} == {"props.png", "robots.png"}


@pytest.mark.usefixtures("one_process")
def test_only_the_given_sets_are_evaluated(assets: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["assets", "--data", str(assets), "--set", "props"]) == 0
    assert "1 models of 1 sets" in capsys.readouterr().out


@pytest.mark.usefixtures("one_process")
def test_folds_replace_the_models_that_ship(assets: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    document = learned_models().document()
    (tmp_path / "props.json").write_text(json.dumps({"left_out": ["props/crate", 5], "models": document}))
    options = ["assets", "--data", str(assets), "--folds", str(tmp_path)]
    assert main([*options, "--set", "props"]) == 0
    capsys.readouterr()
    assert main(options) == 2
    assert "No fold leaves out model robots/bell" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--set", "props", "ships"], "There is no set 'ships'"),
        (["--parameters", "seed=1"], "give it with --seed"),
        (["--parameters", "max_segments=0"], "max_segments must be"),
        (["--jobs", "0"], "at least 1"),
        (["--limit", "0"], "at least 1 model"),
        (["--output", "no/such/folder.json"], "create it first"),
        (["--folds", "nowhere"], "bench train --folds"),
    ],
)
def test_a_command_that_cannot_run_prints_one_sentence(
    options: list[str], message: str, assets: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["assets", "--data", str(assets), *options]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1
