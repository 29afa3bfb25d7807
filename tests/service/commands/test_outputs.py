"""Outputs of the commands: every format of WRITERS by its extension, with its options."""

import io
import zipfile
from pathlib import Path

import numpy as np
import pytest
import trimesh

from segcore.io import read_mesh
from segcore.io.result import read_result
from segcore.io.writing import WRITERS
from segcore.levels import Fineness
from service.commands.main import main
from service.commands.summary import level_summary


@pytest.mark.parametrize("command", ["segment", "convert"])
def test_the_help_lists_the_extensions_of_the_writers(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main([command, "--help"])
    words = capsys.readouterr().out.split()
    first = words.index(".glb")
    listed = [word.rstrip(";") for word in words[first : first + len(WRITERS)]]
    assert listed == [writer.extension for writer in WRITERS.values()]


@pytest.mark.parametrize("kind", WRITERS)
def test_a_result_is_converted_to_what_segment_would_have_written(ball: Path, tmp_path: Path, kind: str) -> None:
    extension = WRITERS[kind].extension
    converted, direct = (tmp_path / folder / f"model{extension}" for folder in ("converted", "direct"))
    for path in (converted, direct):
        path.parent.mkdir()
    assert main(["convert", str(ball / "ball.cleave"), "--segments", "9", "-o", str(converted)]) == 0
    assert main(["segment", str(ball / "ball.off"), "--segments", "9", "-o", str(direct)]) == 0
    assert converted.read_bytes() == direct.read_bytes()
    opened, target = read_result(ball / "ball.cleave"), io.BytesIO()
    WRITERS[kind].write(target, opened.mesh, opened.hierarchy, 9)
    assert converted.read_bytes() == target.getvalue()


def test_several_outputs_at_once_and_the_options_of_formats(
    ball: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    glb, archive, labels = (tmp_path / name for name in ("ball.glb", "parts.zip", "ball.npy"))
    outputs = ["-o", str(glb), "-o", str(archive), "-o", str(labels)]
    options = ["--all-levels", "--features", "--capped", "--parts", "obj"]
    assert main(["convert", str(ball / "ball.cleave"), "--segments", "4", *outputs, *options]) == 0
    assert all(word in glb.read_bytes() for word in (b"KHR_materials_variants", b"EXT_structural_metadata"))
    with zipfile.ZipFile(archive) as parts:
        *names, last = parts.namelist()
        assert (names, last) == ([f"segment_{k}.obj" for k in range(4)], "parts.json")
        for name in names:
            assert trimesh.load(io.BytesIO(parts.read(name)), file_type="obj").is_watertight
    hierarchy = read_result(ball / "ball.cleave").hierarchy
    assert np.load(labels).tolist() == hierarchy.labels(4).tolist()
    expected = [level_summary(hierarchy, 4, Fineness(segments=4))]
    assert capsys.readouterr().out.splitlines() == expected + [f"wrote {path}" for path in (glb, archive, labels)]


def test_everything_of_the_input_is_kept_on_request(ball: Path, tmp_path: Path) -> None:
    kept, plain, archive, converted = (tmp_path / name for name in ("kept.glb", "plain.glb", "parts.zip", "again.glb"))
    mesh, result = ball / "ball.off", ball / "ball.cleave"
    arguments = ["segment", str(mesh), "--segments", "4", "--parts", "glb", "-o", str(archive)]
    assert main([*arguments, "-o", str(kept), "--keep", "all"]) == 0
    assert main([*arguments, "-o", str(plain)]) == 0
    assert b"original look" in kept.read_bytes()
    assert b"original look" not in plain.read_bytes()
    with zipfile.ZipFile(archive) as parts:
        assert parts.namelist() == [f"segment_{k}.glb" for k in range(4)]
        faces = [len(read_mesh(io.BytesIO(parts.read(name))).faces) for name in parts.namelist()]
    assert sum(faces) == len(read_mesh(mesh).faces)
    source = ["--source", str(mesh), "--keep", "all"]
    assert main(["convert", str(result), "--segments", "4", "-o", str(converted), *source]) == 0
    assert converted.read_bytes() == kept.read_bytes()


def test_what_cannot_be_kept_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "a.mtl").write_text("newmtl red\nmap_Kd red.png\n")
    (tmp_path / "a.obj").write_text("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl red\nf 1 2 3\nf 1 3 4\n")
    assert main(["segment", str(tmp_path / "a.obj"), "-o", str(tmp_path / "a.glb"), "--keep", "all"]) == 0
    assert "The picture 'red.png' is not in the set or cannot be read: it is left out." in capsys.readouterr().out


@pytest.mark.parametrize(("option", "is_closed"), [([], True), (["--capped"], True), (["--open"], False)])
def test_parts_for_printing_are_closed_unless_they_are_to_be_open(
    ball: Path, tmp_path: Path, option: list[str], is_closed: bool
) -> None:
    outputs = ["-o", str(tmp_path / "ball.3mf"), "-o", str(tmp_path / "ball.zip")]
    assert main(["convert", str(ball / "ball.cleave"), "--segments", "3", *outputs, *option]) == 0
    parts = list(trimesh.load(tmp_path / "ball.3mf").geometry.values())
    with zipfile.ZipFile(tmp_path / "ball.zip") as archive:
        parts += [trimesh.load(io.BytesIO(archive.read(f"segment_{k}.stl")), file_type="stl") for k in range(3)]
    assert [part.is_watertight for part in parts] == [is_closed] * 6


def test_parts_are_either_open_or_closed(ball: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["convert", str(ball / "ball.cleave"), "-o", str(tmp_path / "ball.3mf"), "--open", "--capped"])
    assert "not allowed with" in capsys.readouterr().err


@pytest.mark.parametrize("command", ["segment", "convert"])
def test_the_materials_of_an_obj_file_are_written_beside_it(ball: Path, tmp_path: Path, command: str) -> None:
    source = ball / ("ball.off" if command == "segment" else "ball.cleave")
    target = tmp_path / "a ball.obj"
    assert main([command, str(source), "--segments", "3", "-o", str(target)]) == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a ball.mtl", "a ball.obj"]
    assert "\nmtllib a ball.mtl\n" in target.read_text()
    assert target.with_suffix(".mtl").read_text().count("newmtl ") == 3


def test_the_vertices_of_ply_are_those_of_the_input_if_colours_are_on_faces(ball: Path, tmp_path: Path) -> None:
    count = len(read_result(ball / "ball.cleave").mesh.vertices)
    for option, is_divided in ([], True), (["--colors", "faces"], False):
        target = tmp_path / "ball.ply"
        assert main(["convert", str(ball / "ball.cleave"), "--segments", "3", "-o", str(target), *option]) == 0
        assert (len(trimesh.load(target, process=False).vertices) > count) == is_divided
