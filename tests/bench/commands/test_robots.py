"""The robots command on a small mesh."""

from pathlib import Path

import pytest

from bench.__main__ import main
from helpers.simulation.shapes import table
from segcore.io import write_mesh


def test_a_table_stands(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_mesh(tmp_path / "table.off", table()[0])
    assert main(["robots", str(tmp_path / "table.off")]) == 0
    heads, _, row = capsys.readouterr().out.splitlines()
    cells = dict(zip(heads.split(" | "), row.split(" | "), strict=True))
    assert (cells["links"], cells["closed"], cells["balanced"]) == ("5", "5", "yes")
    assert float(cells["parts / whole"]) == pytest.approx(1)
    assert float(cells["moved"]) < 1e-3


def test_a_file_that_does_not_exist_is_status_2(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["robots", str(tmp_path / "nothing.off")]) == 2
    assert "nothing.off" in capsys.readouterr().err
