"""The files of the Princeton benchmark are read as other readers read them."""

import os
from pathlib import Path

import meshio
import numpy as np
import pytest

from helpers.files.plain_readers import slow_off
from segcore.io import read_mesh

FOLDER = os.environ.get("CLEAVE_PSB_DIR", "")
SAMPLE = 12  # files, spread over the categories


@pytest.fixture(scope="module")
def paths() -> list[Path]:
    found = sorted(Path(FOLDER, "off").glob("*.off"), key=lambda path: int(path.stem)) if FOLDER else []
    if not found:
        pytest.skip("CLEAVE_PSB_DIR is not a folder of the benchmark, with off/N.off in it")
    return found[:: max(1, len(found) // SAMPLE)]


def test_meshio_reads_the_same_vertices_and_faces(paths: list[Path]) -> None:
    for path in paths:
        mesh, theirs = read_mesh(path), meshio.read(path)
        (block,) = theirs.cells
        assert np.array_equal(mesh.faces, block.data)
        np.testing.assert_allclose(mesh.vertices, theirs.points, rtol=1e-15)


def test_a_slow_reader_reads_the_same_bit_for_bit(paths: list[Path]) -> None:
    for path in paths[::3]:
        vertices, faces = slow_off(path.read_bytes())
        mesh = read_mesh(path)
        assert mesh.vertices.tolist() == [list(vertex) for vertex in vertices]
        assert mesh.faces.tolist() == [list(face) for face in faces]
