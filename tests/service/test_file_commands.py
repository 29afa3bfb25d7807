"""`cleave segment -o`, `cleave convert` and `cleave inspect`: every format by its extension, without a server."""

import io
import json
import zipfile
from pathlib import Path

import numpy as np
import pytest
import trimesh

import segcore
from helpers.jobs import sphere
from segcore.io.result import read_result
from segcore.io.writing import WRITERS
from segcore.report import mesh_report
from service.commands.file_arguments import OUTPUTS
from service.commands.main import main


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A mesh and its result."""
    folder = tmp_path_factory.mktemp("ball")
    (folder / "ball.off").write_bytes(sphere(12))
    assert main(["segment", str(folder / "ball.off"), "--result", str(folder / "ball.cleave")]) == 0
    return folder


def test_the_extensions_of_the_command_line_are_those_of_the_writers() -> None:
    assert OUTPUTS.split() == [writer.extension for writer in WRITERS.values()]


@pytest.mark.parametrize("kind", WRITERS)
def test_a_result_is_converted_to_what_segment_would_have_written(folder: Path, tmp_path: Path, kind: str) -> None:
    extension = WRITERS[kind].extension
    converted, direct = tmp_path / f"converted{extension}", tmp_path / f"direct{extension}"
    assert main(["convert", str(folder / "ball.cleave"), "--segments", "9", "-o", str(converted)]) == 0
    assert main(["segment", str(folder / "ball.off"), "--segments", "9", "-o", str(direct)]) == 0
    assert converted.read_bytes() == direct.read_bytes()
    opened, target = read_result(folder / "ball.cleave"), io.BytesIO()
    WRITERS[kind].write(target, opened.mesh, opened.hierarchy, 9)
    assert converted.read_bytes() == target.getvalue()


def test_several_outputs_at_once_and_the_options_of_formats(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    glb, archive, labels = (tmp_path / name for name in ("ball.glb", "parts.zip", "ball.npy"))
    outputs = ["-o", str(glb), "-o", str(archive), "-o", str(labels)]
    options = ["--all-levels", "--features", "--capped", "--parts", "obj"]
    assert main(["convert", str(folder / "ball.cleave"), "--segments", "4", *outputs, *options]) == 0
    assert all(word in glb.read_bytes() for word in (b"KHR_materials_variants", b"EXT_structural_metadata"))
    with zipfile.ZipFile(archive) as parts:
        assert parts.namelist() == [f"segment_{k}.obj" for k in range(4)]
        for name in parts.namelist():
            assert trimesh.load(io.BytesIO(parts.read(name)), file_type="obj").is_watertight
    hierarchy = read_result(folder / "ball.cleave").hierarchy
    assert np.load(labels).tolist() == hierarchy.labels(4).tolist()
    expected = [f"4 segments, as asked; 1 to {hierarchy.max_segments} are possible"]
    assert capsys.readouterr().out.splitlines() == expected + [f"wrote {path}" for path in (glb, archive, labels)]


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["convert", "ball.off", "-o", "a.ply"], "This is not a .cleave file"),
        (["convert", "none.cleave", "-o", "a.ply"], "none.cleave: No such file or directory."),
        (["convert", "ball.cleave", "-o", "a.ply", "--segments", "9999"], "from 1 to"),
        (["convert", "ball.cleave", "-o", "a.dae"], "'a.dae' must end in one of .glb"),
        (["convert", "ball.cleave", "-o", "no/a.ply"], "no: There is no such folder."),
        (["convert", "ball.cleave"], "-o/--output"),
        (["inspect", "none.off"], "none.off: No such file or directory."),
        (["inspect", "ball.cleave"], "cleave convert"),
    ],
)
def test_what_cannot_be_done_is_one_line_and_status_2(
    folder: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    arguments: list[str],
    sentence: str,
) -> None:
    monkeypatch.chdir(folder)
    try:
        status = main(arguments)
    except SystemExit as exit_of_the_parser:
        status = int(str(exit_of_the_parser.code))
    output, errors = capsys.readouterr()
    assert (status, output, errors.count("\n")) == (2, "", 1)
    assert errors.startswith("cleave: ")
    assert sentence in errors
    assert not (folder / "a.ply").exists()


def test_inspect_as_json_is_the_report(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["inspect", "--json", str(folder / "ball.off")]) == 0
    document = json.loads(capsys.readouterr().out)
    report = mesh_report(segcore.read_mesh(folder / "ball.off"))
    assert document["faces"] == report.faces
    assert document["lower"] == list(report.lower)
    assert document["volume"] == report.volume


def test_inspect_for_people_says_what_is_not_as_it_should_be(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
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


def test_inspect_finds_nothing_wrong_with_a_ball(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["inspect", str(folder / "ball.off")]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[2:] == ["1 component, closed"]
    assert ", volume " in lines[1]
