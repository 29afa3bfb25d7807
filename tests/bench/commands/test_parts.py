"""The parts command on constructed bodies, an asset and a small mesh."""

from pathlib import Path

import pytest

from bench.__main__ import main
from segcore import shapes
from segcore.io import write_mesh


def test_the_copies_of_constructed_bodies_are_found(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["parts", "--fineness", "1"]) == 0
    rows = [line.split(" | ") for line in capsys.readouterr().out.splitlines() if line.startswith("| ")][1:]
    assert [row[0][2:] for row in rows] == [
        "chain of 40 links",
        "table",
        "wheels",
        "hands",
        "bolts of 3 lengths",
        "balls",
    ]
    assert {row[4] for row in rows} == {"right"}


def test_pasted_parts_of_an_asset_are_grouped(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    body = shapes.joined(shapes.box(), shapes.box((1.0, 2.0, 3.0), (5.0, 0.0, 0.0)), shapes.box(centre=(0.0, 5.0, 0.0)))
    (tmp_path / "props").mkdir()
    write_mesh(tmp_path / "props" / "boxes.ply", body.mesh)
    (tmp_path / "props" / "boxes.seg").write_text("".join(f"{part}\n" for part in body.parts))
    (tmp_path / "models.tsv").write_text("set\tname\tfaces\tparts\tcomponents\tcomponents_1rand\tkmeans_1rand\n")
    with (tmp_path / "models.tsv").open("a") as table:
        table.write("props\tboxes\t36\t3\t3\t0\t0\n")
    assert main(["parts", "--fineness", "--assets", str(tmp_path)]) == 0
    row = capsys.readouterr().out.splitlines()[-1].split(" | ")
    assert row[:5] == ["| props", "1", "36", "3", "3"]
    assert row[6:] == ["1", "1", "0 |"]


def test_meshes_are_cut_first(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_mesh(tmp_path / "burr.off", shapes.burr(3).mesh)
    assert main(["parts", "--fineness", "--meshes", str(tmp_path / "burr.off")]) == 0
    assert capsys.readouterr().out.splitlines()[-1].startswith("| burr.off | 1280 | 7 | ")
    assert main(["parts", "--fineness", "--meshes", str(tmp_path / "nothing.off")]) == 2
    assert "nothing.off" in capsys.readouterr().err
