"""`cleave inspect`: the report of a mesh file as text and as JSON."""

import json
import re
from pathlib import Path

import pytest

import segcore
from helpers.files.samples import TWO_SQUARES
from helpers.meshes import refined
from segcore import shapes
from segcore.io import read_result, write_mesh
from segcore.part_list.document import part_list_document
from segcore.report import mesh_report
from service.commands.main import main


def test_the_json_output_is_the_report(ball: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["inspect", "--json", str(ball / "ball.off")]) == 0
    document = json.loads(capsys.readouterr().out)
    report = mesh_report(segcore.read_mesh(ball / "ball.off"))
    assert document["faces"] == report.faces
    assert document["lower"] == list(report.lower)
    assert document["volume"] == report.volume


def test_the_text_lists_every_kind_of_defect(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "odd.obj"
    vertices = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 1 1 0\nv 9 9 9\n"
    path.write_text(f"{vertices}o sheet\nf 1 2 3 4\nf 3 2 1\nf 5 3 1\n")
    assert main(["inspect", str(path)]) == 0
    assert capsys.readouterr().out.splitlines() == [
        "odd.obj: 4 faces, 6 vertices, 3 polygons",
        "size 1 x 1 x 0, area 1",
        "1 component, not closed",
        "4 border edges, with a face on one side only",
        "1 duplicate face, with the corners of an earlier one",
        "1 degenerate face, with two corners at one place",
        "1 welded vertex, at the same place as another one",
        "1 unused vertex, which no face has",
        "1 group: sheet",
    ]


def test_the_text_lists_no_defect_of_a_ball(ball: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["inspect", str(ball / "ball.off")]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[2:] == ["1 component, closed"]
    assert ", volume " in lines[1]


def test_the_text_has_the_structure_of_a_file_of_several_parts(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "two.obj"
    path.write_text(TWO_SQUARES)
    assert main(["inspect", str(path)]) == 0
    assert capsys.readouterr().out.splitlines()[-2:] == [
        "structure: 2 shells, 2 groups, 1 material",
        "2 groups: left, right",
    ]
    assert main(["inspect", "--json", str(path)]) == 0
    assert json.loads(capsys.readouterr().out)["structure"] == {"shells": 2, "groups": 2, "materials": 1}


def test_the_text_says_what_was_stitched(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Two squares with a crack of 0.001 between them, one of them of half the height: a corner stands on an edge."""
    path = tmp_path / "cracked.obj"
    right = "v 1.001 0 0\nv 2 0 0\nv 2 0.5 0\nv 1.001 0.5 0\n"
    path.write_text(f"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n{right}f 1 2 3 4\nf 5 6 7 8\n")
    assert main(["inspect", str(path)]) == 0
    assert capsys.readouterr().out.splitlines()[2:5] == [
        "1 component, not closed",
        "2 border edges stitched, across gaps of up to 0.001",
        "8 border edges, with a face on one side only",
    ]


def test_the_size_has_its_unit_and_the_axis_that_points_up(ball: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["inspect", str(ball / "ball.off"), "--unit", "mm", "--up", "z"]) == 0
    assert re.search(r"\nsize [\d.]+ x [\d.]+ x [\d.]+ millimeter z up, area ", capsys.readouterr().out)
    with pytest.raises(SystemExit, match="2"):
        main(["inspect", str(ball / "ball.off"), "--unit", "milimeter"])
    assert "as in 'millimeter'" in capsys.readouterr().err


@pytest.fixture(scope="module")
def table(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A mesh of a top and four legs that stand below it, table.ply, and its result, table.cleave."""
    folder = tmp_path_factory.mktemp("table")
    legs = [shapes.box((0.3, 0.3, 2.0), (x, y, -1.2)) for x in (-1.7, 1.7) for y in (-1.2, 1.2)]
    mesh = refined(shapes.joined(shapes.box((4.0, 3.0, 0.2)), *legs).mesh, 2)
    write_mesh(folder / "table.ply", mesh)
    assert main(["segment", str(folder / "table.ply"), "--result", str(folder / "table.cleave")]) == 0
    return folder


@pytest.mark.parametrize("name", ["table.ply", "table.cleave"])
def test_the_list_of_parts_names_the_copies(table: Path, name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["inspect", "--parts", str(table / name), "--segments", "5"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == f"{name}: 5 parts"
    assert lines[1] == "  part 0: 192 faces, area 26.8, volume 2.4, box 4 x 3 x 0.2"
    assert lines[2] == "  part 1: 192 faces, area 2.58, volume 0.18, box 2 x 0.3 x 0.3"
    assert lines[6].startswith("equal: 4 parts, 1, 2, 3, 4; they deviate by up to ")


def test_the_list_of_parts_as_json_is_that_of_the_server(table: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["inspect", "--parts", "--json", str(table / "table.cleave"), "--segments", "2"]) == 0
    document = json.loads(capsys.readouterr().out)
    result = read_result(table / "table.cleave")
    assert document == part_list_document(segcore.parts(result.mesh, result.hierarchy.labels(2)))


def test_edited_parts_are_listed_with_their_names(
    table: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    operations = [{"op": "name", "part": part, "name": "leg"} for part in (1, 2, 3, 4)]
    edits, edited = tmp_path / "edits.json", tmp_path / "edited.cleave"
    edits.write_text(json.dumps({"level": {"segments": 5}, "operations": operations}))
    assert main(["edit", str(table / "table.cleave"), "--operations", str(edits), "-o", str(edited)]) == 0
    capsys.readouterr()
    assert main(["inspect", "--parts", str(edited)]) == 0
    assert capsys.readouterr().out.count("'leg'") == 4


def test_a_level_without_parts_is_refused(ball: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["inspect", str(ball / "ball.off"), "--segments", "4"]) == 2
    assert "add --parts" in capsys.readouterr().err
    assert main(["inspect", "--parts", str(ball / "ball.cleave"), "--segments", "4000"]) == 2
    assert "from 1 to" in capsys.readouterr().err
