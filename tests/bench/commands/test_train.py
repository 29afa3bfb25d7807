"""The train command on a folder of small models."""

import json
from pathlib import Path

import pytest

from bench.__main__ import main
from bench.learning.folds import read_folds
from segcore.learned.models import LearnedModels


def test_training_twice_writes_the_same_bytes_and_folds_for_an_evaluation(
    shapes_folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], request: pytest.FixtureRequest
) -> None:
    """Once in a process of its own for every step, then in this process."""
    outputs = [tmp_path / "one.json", tmp_path / "two.json"]
    folds = tmp_path / "folds"
    for output in outputs:
        command = ["train", "--data", str(shapes_folder), "--output", str(output), "--folds", str(folds)]
        assert main(command) == 0
        request.getfixturevalue("one_process")
    assert outputs[0].read_bytes() == outputs[1].read_bytes()
    LearnedModels.from_document(json.loads(outputs[0].read_text()))
    assert sorted(path.name for path in folds.iterdir()) == ["bell.json", "burr.json"]
    assert set(read_folds(folds)) == {1, 3, 21, 23}
    capsys.readouterr()
    assert main(["princeton", "--data", str(shapes_folder), "--learned", str(folds)]) == 0
    assert "Burr" in capsys.readouterr().out


def test_a_folder_without_folds_is_an_error(
    shapes_folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["princeton", "--data", str(shapes_folder), "--learned", str(tmp_path / "none")]) == 2
    assert "bench train --folds" in capsys.readouterr().err
