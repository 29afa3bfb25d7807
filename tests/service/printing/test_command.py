"""`cleave convert --print`."""

import json
from pathlib import Path

import pytest

import segcore
from helpers.printing.bars import bar
from segcore.coordinates import Coordinates
from segcore.io import write_result
from service.commands.main import main


@pytest.fixture
def result(tmp_path: Path) -> Path:
    """A .cleave file of a bar with two parts."""
    with (tmp_path / "bar.cleave").open("wb") as target:
        write_result(target, *bar(coordinates=Coordinates()))
    return tmp_path / "bar.cleave"


def test_a_print_and_its_report_are_written(result: Path, capsys: pytest.CaptureFixture[str]) -> None:
    model, report = result.with_name("bar.3mf"), result.with_name("bar.json")
    options = ["--print", "--connectors", "peg", "--size", "120", "--slots", "1", "--print-report", str(report)]
    assert main(["convert", str(result), "-o", str(model), *options]) == 0
    output = capsys.readouterr().out
    assert "2 objects, 1 filaments, connectors at 1 of 1 contacts" in output
    connector = json.loads(report.read_text())["contacts"][0]["connector"]
    assert connector["kind"] == "peg"
    side_by_side = 60 + 60 + connector["depth"] + 8  # two halves, the peg of one, and the gap
    assert segcore.read_mesh(model).bounds[1].max() == pytest.approx(side_by_side)
    assert main(["convert", str(result), "-o", str(model), "--print", "--connectors", "none"]) == 0
    assert "its lengths are taken as mm" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["-o", "bar.3mf", "--slots", "2"], "--slots is an option of --print"),
        (["-o", "bar.3mf", "--print-report", "a.json"], "--print-report is an option of --print"),
        (["-o", "bar.glb", "--print"], "ends in .3mf"),
        (["-o", "bar.3mf", "--print", "--bed", "9x9x9"], "bed must be three lengths"),
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
    assert not (result.parent / "bar.3mf").exists()
