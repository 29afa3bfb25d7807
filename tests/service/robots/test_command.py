"""`cleave convert --robot`."""

import json
import zipfile
from pathlib import Path

import pytest

from helpers.printing.bars import bar, bent_bar
from segcore.coordinates import Coordinates
from segcore.io import write_result
from service.commands.main import main


@pytest.fixture
def result(tmp_path: Path) -> Path:
    """A .cleave file of a bar with two parts."""
    with (tmp_path / "bar.cleave").open("wb") as target:
        write_result(target, *bar(coordinates=Coordinates()))
    return tmp_path / "bar.cleave"


def test_a_robot_is_written(result: Path, capsys: pytest.CaptureFixture[str]) -> None:
    robot = result.with_name("bar.zip")
    options = ["--robot", "--joints", "hinge", "--length", "0.6", "--density", "500"]
    assert main(["convert", str(result), "-o", str(robot), *options]) == 0
    assert "2 links, 1 hinges, 2 convex pieces, 12 kg" in capsys.readouterr().out
    with zipfile.ZipFile(robot) as archive:
        assert json.loads(archive.read("robot.json"))["mass"] == pytest.approx(12)
    assert main(["convert", str(result), "-o", str(robot), "--robot"]) == 0
    assert "its lengths are taken as metres" in capsys.readouterr().out


def test_reasons_are_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with (tmp_path / "bar.cleave").open("wb") as target:
        write_result(target, *bent_bar())
    options = ["--robot", "--joints", "hinge", "--collision", "hull", "-o", str(tmp_path / "bar.zip")]
    assert main(["convert", str(tmp_path / "bar.cleave"), *options]) == 0
    assert "is fixed: the border is not plane" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["-o", "bar.zip", "--density", "2"], "--density is an option of --robot"),
        (["-o", "bar.glb", "--robot"], "ends in .zip"),
        (["-o", "bar.zip", "--robot", "--pieces", "0"], "pieces must be from 1 to 64"),
        (["-o", "bar.3mf", "--robot", "--print"], "give --print or --robot"),
    ],
)
def test_an_expected_error_is_one_line_and_status_2(
    result: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    arguments: list[str],
    sentence: str,
) -> None:
    monkeypatch.chdir(result.parent)
    assert main(["convert", str(result), *arguments]) == 2
    errors = capsys.readouterr().err
    assert errors.count("\n") == 1
    assert sentence in errors
    assert list(result.parent.iterdir()) == [result]
