"""The clicks command: training, its files, and evaluation with them."""

import json
from pathlib import Path

import pytest

from bench.__main__ import main
from segcore.edit.corrections import FEATURES
from segcore.edit.tree_parts import FEATURES as PART_FEATURES
from segcore.learned.choices import ChoiceModels


@pytest.mark.usefixtures("one_process")
def test_choices_are_learned_and_evaluated_without_the_set_of_a_model(
    shapes_folder: Path, assets: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    learned, folds = tmp_path / "choices.json", tmp_path / "folds"
    options = ["clicks", "--data", str(shapes_folder), "--assets", str(assets)]
    assert main([*options, "--train", str(learned), "--choice-folds", str(folds)]) == 0
    models = ChoiceModels.from_document(json.loads(learned.read_text()))
    assert models.part.names == PART_FEATURES
    assert models.correction.names == FEATURES
    left_out = {path.name: json.loads(path.read_text())["left_out"] for path in folds.iterdir()}
    of_assets = {"props.json": ["props/crate"], "robots.json": ["robots/bell"]}
    assert left_out == {"burr.json": [1, 3], "bell.json": [21, 23], **of_assets}
    capsys.readouterr()
    assert main([*options, "--choice-folds", str(folds)]) == 0
    printed = capsys.readouterr().out
    row = next(line for line in printed.splitlines() if line.startswith("all"))
    after_one, after_ten = float(row.split()[2]), float(row.split()[6])
    assert 0.3 < after_one <= after_ten <= 1.0
    (folds / "robots.json").unlink()
    assert main([*options, "--choice-folds", str(folds)]) == 2
    assert "robots/bell" in capsys.readouterr().err


@pytest.mark.usefixtures("one_process")
def test_one_click_models_are_not_enough_to_learn_from(
    assets: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    options = ["clicks", "--assets", str(assets), "--limit", "1", "--train", str(tmp_path / "choices.json")]
    assert main(options) == 2
    assert "no part needs a second click" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ([], "--data or --assets"),
        (["--jobs", "0"], "at least 1"),
        (["--train", "no/such/file.json"], "create it first"),
        (["--choice-folds", "nowhere"], "bench clicks --choice-folds"),
    ],
)
def test_a_command_that_cannot_run_prints_one_sentence(
    options: list[str], message: str, assets: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = [] if options == [] else ["--assets", str(assets)]
    assert main(["clicks", *folder, *options]) == 2
    assert message in capsys.readouterr().err


def test_the_time_of_clicks_is_measured_at_several_sizes(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["clicks", "--sizes", "300", "1300"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines[-2:]] == ["320", "1,280"]
    assert all(len(line.split()) == 6 for line in lines[-2:])
