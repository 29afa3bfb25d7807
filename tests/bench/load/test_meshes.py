"""The meshes of the load measurements."""

import io

import numpy as np
import pytest

import segcore
from bench.load.meshes import wavy_torus


@pytest.mark.parametrize("faces", [2_000, 20_000])
def test_the_torus_is_a_closed_mesh_with_about_the_number_of_faces(faces: int) -> None:
    mesh = segcore.read_mesh(io.BytesIO(wavy_torus(faces)))
    assert abs(len(mesh.faces) - faces) < 0.05 * faces
    edges = np.sort(mesh.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()
    assert len(np.unique(mesh.faces)) == len(mesh.vertices)
