"""Oriented boxes: they hold all points, and are about as small as those of trimesh."""

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from helpers.meshes import rotation
from segcore.part_list.boxes import OrientedBox, oriented_box

BODIES = {
    "capsule": trimesh.creation.capsule(3.0, 1.0),
    "cone": trimesh.creation.cone(1.0, 2.0),
    "torus": trimesh.creation.torus(2.0, 0.5),
    "ball": trimesh.creation.icosphere(3),
}


def holds(box: OrientedBox, points: np.ndarray) -> bool:
    along = (points - box.centre) @ box.axes.T
    return bool((np.abs(along) <= 0.5 * box.extents + 1e-9 * (1.0 + box.diagonal)).all())


@pytest.mark.parametrize("name", BODIES)
def test_the_volume_is_that_of_trimesh_within_a_few_percent(name: str) -> None:
    rng = np.random.default_rng(1)
    body = BODIES[name].copy()
    body.vertices = body.vertices @ rotation(rng).T + rng.normal(size=3)
    box = oriented_box(body.vertices, 24)
    assert holds(box, body.vertices)
    assert np.prod(box.extents) <= 1.05 * body.bounding_box_oriented.volume


@given(st.integers(0, 2**32 - 1), st.integers(1, 60), st.integers(0, 3))
@settings(max_examples=40, deadline=None)
def test_any_points_are_in_a_box_with_right_handed_axes(seed: int, count: int, dimensions: int) -> None:
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(count, 3)) * (np.arange(3) < dimensions) @ rotation(rng) + rng.normal(size=3)
    box = oriented_box(points, 24)
    assert holds(box, points)
    np.testing.assert_allclose(box.axes @ box.axes.T, np.eye(3), atol=1e-9)
    assert np.linalg.det(box.axes) > 0.0
    assert (np.diff(box.extents) <= 0.0).all()


def test_a_turned_box_is_found_exactly() -> None:
    rng = np.random.default_rng(2)
    turn = rotation(rng)
    body = trimesh.creation.box((3.0, 2.0, 1.0)).subdivide().subdivide().subdivide()
    box = oriented_box(body.vertices @ turn.T + [5.0, 6.0, 7.0], 24)
    np.testing.assert_allclose(box.extents, [3.0, 2.0, 1.0])
    np.testing.assert_allclose(box.centre, [5.0, 6.0, 7.0])
    np.testing.assert_allclose(np.abs(box.axes @ turn), np.eye(3), atol=1e-9)


def test_a_flat_part_has_a_flat_box() -> None:
    sheet = trimesh.creation.box((2.0, 1.0, 0.0)).vertices @ rotation(np.random.default_rng(3)).T
    np.testing.assert_allclose(oriented_box(sheet, 24).extents, [2.0, 1.0, 0.0], atol=1e-12)
