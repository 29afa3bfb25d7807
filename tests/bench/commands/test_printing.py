"""The printing command on a small mesh."""

from pathlib import Path

import pytest

from bench.__main__ import main
from helpers.bodies.creatures import creature
from helpers.printing.bars import bar
from helpers.printing.slicers import needs_slicer
from segcore.io import write_mesh


@needs_slicer
def test_every_mesh_has_a_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_mesh(tmp_path / "creature.off", creature(subdivisions=3))
    assert main(["printing", str(tmp_path / "creature.off"), "--segments", "6"]) == 0
    assert capsys.readouterr().out.splitlines()[2:] == ["| creature.off | 1280 | 6 | 6 of 6 | 6 of 6 |"]


@needs_slicer
def test_prints_are_sliced_with_their_filaments(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_mesh(tmp_path / "bar.off", bar()[0])
    options = ["--connectors", "dowel", "--slots", "2", "--size", "60", "--segments", "1"]
    assert main(["printing", str(tmp_path / "bar.off"), *options]) == 0
    (line,) = capsys.readouterr().out.splitlines()[2:]
    assert line.startswith("| bar.off | 192 | 1 | 0 of 0 | 1 of 1 | ")
    assert line.endswith(" | 0 of 1 |")  # one filament needs no change


def test_a_missing_slicer_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    write_mesh(tmp_path / "creature.off", creature(subdivisions=3))
    monkeypatch.setenv("PATH", str(tmp_path))
    assert main(["printing", str(tmp_path / "creature.off")]) == 2
    assert "install the Debian package prusa-slicer" in capsys.readouterr().err


def test_a_file_that_cannot_be_read_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["printing", str(tmp_path / "nothing.off")]) == 2
    assert "nothing.off" in capsys.readouterr().err
