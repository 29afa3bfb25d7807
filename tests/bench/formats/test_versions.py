"""Two versions of Cleave are timed in turn on the same files."""

from pathlib import Path

import pytest

from bench.checkout import checked_out
from bench.errors import BenchmarkError
from bench.formats.samples import LOOKED_AT, MORE, READ, write_more, write_usual
from bench.formats.versions import compare
from segcore.io import read_mesh

ROOT = Path(__file__).parents[3]
FACES = 400


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for stem in ("mesh", "small"):
        write_usual(tmp_path, stem, FACES)
        write_more(tmp_path, stem, FACES)
    return tmp_path


def test_all_files_have_the_same_faces(folder: Path) -> None:
    area = read_mesh(folder / "mesh.ply").corners.sum()
    for name in (READ | MORE).values():
        mesh = read_mesh(folder / name)
        assert len(mesh.faces) == FACES
        assert mesh.corners.sum() == pytest.approx(area, abs=1e-2)
    textured = read_mesh(folder / MORE[LOOKED_AT[-1]], appearance=True).appearance
    assert textured is not None
    assert textured.uvs is not None
    assert textured.normals is not None
    assert textured.group_names == ("part_0", "part_1")


def test_both_versions_are_timed(folder: Path) -> None:
    lines = [
        f"{action} {folder / name}"
        for action, name in (("read", "mesh.off"), ("look", "mesh.ply"), ("write", "mesh.obj"))
    ]
    for times in compare(ROOT, lines, 2):
        assert min(times) > 0
    assert (folder / "mesh.obj").read_bytes().count(b"\no ") == 8
    with pytest.raises(BenchmarkError, match=r"could not read .*missing\.off"):
        next(compare(ROOT, [f"read {folder / 'missing.off'}"], 1))


def test_an_unknown_version_is_named() -> None:
    with pytest.raises(BenchmarkError, match="no version 'nowhere'"), checked_out("nowhere"):
        pass
