"""The files command on a folder of small files, against trimesh and against three.js."""

from pathlib import Path

import pytest

from bench.__main__ import main
from bench.commands.files import mesh_files
from helpers.files.posed import blended, copied, morphed
from helpers.files.samples import BINARY_STL, OBJ, OFF, gltf_square
from helpers.node.programs import install

CONCAVE = b"v 0 0 0\nv 2 0 0\nv .1 .1 0\nv 0 2 0\nf 2 3 4 1\n"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    files = {
        "a.off": OFF,
        "deep/b.obj": OBJ,
        "concave.obj": CONCAVE,
        "cut.stl": BINARY_STL[:-9],
        "c.glb": gltf_square().glb(),
    }
    for name, data in files.items():
        (tmp_path / "data" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "data" / name).write_bytes(data)
    (tmp_path / "data" / "notes.txt").write_text("no mesh")
    return tmp_path / "data"


def counts(out: str) -> list[int]:
    """The numbers of files by their verdict, in the order of VERDICTS."""
    (line,) = [line for line in out.splitlines() if line.startswith("all ")]
    return [int(word) for word in line.split()[1:]]


def test_all_meshes_below_a_folder_are_found(folder: Path) -> None:
    names = [str(path.relative_to(folder)) for path in mesh_files(folder)]
    assert names == ["a.off", "c.glb", "concave.obj", "cut.stl", "deep/b.obj"]


def test_readers_agree_or_differ_for_a_reason(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["files", "--data", str(folder)]) == 0
    out = capsys.readouterr().out
    assert counts(out) == [3, 1, 0, 0, 0, 1]
    assert "concave polygons: concave.obj\n" in out
    assert "both refuse: cut.stl: The STL file" in out


@pytest.mark.timeout(300)
def test_three_js_agrees_on_every_corner(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    modules = install("three", tmp_path) / "node_modules"
    data = tmp_path / "data"
    data.mkdir()
    for name, asset in {"skin": blended(), "copies": copied(), "morphs": morphed([0.5, 3])}.items():
        (data / f"{name}.glb").write_bytes(asset.glb())
    (data / "embedded.gltf").write_bytes(gltf_square().gltf())
    (data / "damaged.glb").write_bytes(gltf_square().glb()[:-5])
    assert main(["files", "--data", str(data), "--three", str(modules)]) == 0
    assert counts(capsys.readouterr().out) == [4, 0, 0, 0, 0, 1]


def test_what_is_missing_is_named(tmp_path: Path, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["files", "--data", str(tmp_path / "nothing")]) == 2
    assert "no mesh file" in capsys.readouterr().err
    assert main(["files", "--data", str(folder), "--three", str(tmp_path)]) == 2
    assert "npm install three" in capsys.readouterr().err
