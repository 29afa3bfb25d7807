"""Groups of congruent shells, and which of them are cut alike."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from bench.assets.repeats import Repeats, repeats_of
from segcore import shapes
from segcore.mesh import Mesh, face_normals_and_areas

ROD = shapes.box((0.3, 0.5, 2.0))
TURNED = Mesh(Rotation.from_euler("xyz", (0.3, 0.7, 1.1)).apply(np.add(ROD.vertices, (3.0, 0.0, 0.0))), ROD.faces)
LONGER = shapes.box((0.3, 0.5, 2.1), (6.0, 0.0, 0.0))
SPECK = shapes.box((0.01, 0.01, 0.01), (9.0, 0.0, 0.0))
OTHER_SPECK = shapes.box((0.01, 0.01, 0.01), (9.0, 1.0, 0.0))
SHAPE = shapes.joined(ROD, TURNED, LONGER, SPECK, OTHER_SPECK)
SHELL = SHAPE.parts.astype(np.int32)


def repeats(label: np.ndarray) -> Repeats:
    return repeats_of(SHAPE.mesh, face_normals_and_areas(SHAPE.mesh.corners)[1], SHELL, label.astype(np.int32))


def half_of(shell: int) -> np.ndarray:
    """True for the faces of a shell whose centroids are above those of the others."""
    height = SHAPE.mesh.corners.mean(axis=1)[:, 2]
    own = shell == SHELL
    return own & (height > np.median(height[own]))


@pytest.mark.parametrize(
    ("label", "unlike"),
    [
        (np.zeros_like(SHELL), 0),
        (SHELL, 0),
        (np.where(SHELL == 0, 0, 1), 1),
        (np.where(half_of(1), 5, SHELL), 1),
        (np.where(half_of(2), 5, SHELL), 0),
        (np.where(SHELL == 3, 0, SHELL), 0),
    ],
    ids=["one part", "every shell", "one of two", "one of two divided", "another shell divided", "a speck"],
)
def test_congruent_shells_that_are_cut_differently_are_counted(label: np.ndarray, unlike: int) -> None:
    assert repeats(label) == Repeats(1, unlike)


def test_a_mesh_of_different_shells_has_no_repeats() -> None:
    shape = shapes.joined(ROD, LONGER)
    area = face_normals_and_areas(shape.mesh.corners)[1]
    assert repeats_of(shape.mesh, area, shape.parts, shape.parts) == Repeats(0, 0)
