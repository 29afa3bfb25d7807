"""`cleave edit`: operations on the parts in a file, and `cleave convert` of the result."""

import io
import json
import shutil
import sys
from pathlib import Path

import numpy as np
import pytest
import trimesh

import segcore
from helpers.edits.guide import MarksOnly
from segcore.io import read_result
from service.commands.main import main

EDITS = {
    "level": {"segments": 4},
    "operations": [
        {"op": "merge", "parts": [0, 2]},
        {"op": "name", "part": 0, "name": "body"},
        {"op": "color", "part": 0, "color": "#102030"},
    ],
}


@pytest.fixture
def stored(ball: Path, tmp_path: Path) -> Path:
    """A copy of ball.cleave."""
    return Path(shutil.copy(ball / "ball.cleave", tmp_path / "ball.cleave"))


def edit(file: Path, edits: object, *arguments: str) -> int:
    operations = file.with_name("edits.json")
    operations.write_text(json.dumps(edits))
    return main(["edit", str(file), "--operations", str(operations), *arguments])


def test_a_file_is_edited_again_and_again_and_written_in_any_format(
    stored: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    automatic = read_result(stored).hierarchy
    assert edit(stored, EDITS) == 0
    assert "revision 1: merge parts 0, 2; name part 0 'body'; colour of part 0; 3 parts" in capsys.readouterr().out
    assert edit(stored, {"base": 1, "operations": [{"op": "lock", "part": 0}]}) == 0
    result = read_result(stored)
    assert (result.hierarchy.labels(4) == automatic.labels(4)).all()
    assert result.edited is not None
    assert [note.number for note in result.edited.revisions] == [1, 2]
    assert result.edited.partition.parts[0].locked
    glb, seg = stored.with_suffix(".glb"), stored.with_suffix(".seg")
    assert main(["convert", str(stored), "-o", str(glb), "-o", str(seg)]) == 0
    assert "3 parts of revision 2" in capsys.readouterr().out
    labels = np.loadtxt(seg, dtype=int)
    assert (labels == result.edited.partition.labels).all()
    assert len(trimesh.load(glb).geometry["body"].faces) == (labels == 0).sum()
    assert main(["convert", str(stored), "-o", str(seg), "--segments", "4"]) == 0
    assert (np.loadtxt(seg, dtype=int) == automatic.labels(4)).all()


def test_operations_share_one_guide(stored: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[MarksOnly] = []

    def guide(mesh: segcore.Mesh, _: object) -> MarksOnly:
        made.append(MarksOnly(len(mesh.faces)))
        return made[-1]

    monkeypatch.setattr(segcore, "Guide", guide)
    assert edit(stored, {"operations": [{"op": "part", "inside": [face]} for face in (3, 9)]}) == 0
    assert len(made) == 1


def test_an_output_in_place_of_the_file_and_operations_on_the_standard_input(
    stored: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = stored.read_bytes()
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(json.dumps(EDITS).encode())))
    ply = stored.with_suffix(".ply")
    assert main(["edit", str(stored), "--operations", "-", "-o", str(ply)]) == 0
    assert b"comment label 0 is body" in ply.read_bytes()
    assert stored.read_bytes() == before


@pytest.mark.parametrize(
    ("edits", "sentence"),
    [
        ({"base": 3, "operations": [{"op": "lock", "part": 0}]}, "revision 0 and the edit is one of 3"),
        ({"operations": [{"op": "restore", "revision": 2}]}, "not those of 2"),
        ({"operations": [{"op": "lock", "part": 999}]}, "there is no part 999"),
        ({"operations": [{"op": "melt"}]}, "operations.0 is not valid"),
    ],
)
def test_an_edit_that_cannot_be_made_is_one_line_and_changes_nothing(
    stored: Path, capsys: pytest.CaptureFixture[str], edits: object, sentence: str
) -> None:
    before = stored.read_bytes()
    assert edit(stored, edits) == 2
    errors = capsys.readouterr().err
    assert sentence in errors
    assert errors.count("\n") == 1
    assert stored.read_bytes() == before
