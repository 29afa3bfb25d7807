"""The command ``python -m bench gallery``."""

import struct
from pathlib import Path

from bench.__main__ import main
from segcore import shapes
from segcore.io import write_mesh


def test_files_are_drawn_with_their_levels(tmp_path: Path) -> None:
    files = [str(tmp_path / name) for name in ("one.stl", "two.stl")]
    for file in files:
        write_mesh(file, shapes.burr(3).mesh)
    sheet = tmp_path / "sheet.png"
    assert main(["gallery", "--files", *files, "--levels", "2,7,10000", "--size", "40", "--output", str(sheet)]) == 0
    assert struct.unpack(">II", sheet.read_bytes()[16:24]) == (4 * 40, 2 * 40)
