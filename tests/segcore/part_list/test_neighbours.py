"""Common borders of parts: their lengths and planes."""

import numpy as np
import pytest

import segcore
from helpers.meshes import rotation
from segcore import shapes
from segcore.arrays import IntArray
from segcore.mesh import Mesh


def tube(turn: np.ndarray) -> tuple[Mesh, IntArray]:
    """A cylinder of radius 1 and 64 sides around an axis, its faces below 0 and above."""
    height = np.linspace(-2.0, 2.0, 9)
    mesh = shapes.revolve(np.ones(9), height, 64)
    labels = (mesh.corners[:, :, 2].mean(axis=1) > 0).astype(np.int32)
    return Mesh(mesh.vertices @ turn.T + [7.0, 8.0, 9.0], mesh.faces), labels


def test_the_border_of_two_halves_is_their_circle() -> None:
    turn = rotation(np.random.default_rng(0))
    low, high = segcore.parts(*tube(turn)).parts
    (above,), (below,) = low.neighbours, high.neighbours
    assert (above.part, below.part) == (1, 0)
    assert above.length == below.length == pytest.approx(64 * 2 * np.sin(np.pi / 64))
    assert above.plane is not None
    assert below.plane is not None
    np.testing.assert_allclose(above.plane.point, [7.0, 8.0, 9.0], atol=1e-9)
    np.testing.assert_allclose(above.plane.normal, turn[:, 2], atol=1e-9)  # from the lower half to the upper one
    np.testing.assert_allclose(below.plane.normal, -turn[:, 2], atol=1e-9)
    assert above.plane.largest_deviation == pytest.approx(0.0, abs=1e-9)


def test_the_deviation_is_the_largest_distance_from_the_plane() -> None:
    mesh, labels = tube(np.eye(3))
    bent = mesh.vertices.copy()
    x = bent[:, 0] - 7.0
    bent[:, 2] += 0.1 * (2.0 * x**2 - 1.0)  # a circle as the edge of a saddle
    plane = segcore.parts(Mesh(bent, mesh.faces), labels).parts[0].neighbours[0].plane
    assert plane is not None
    assert plane.largest_deviation == pytest.approx(0.1, rel=1e-2)


def test_a_straight_border_has_no_plane() -> None:
    sheet = Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    (neighbour,) = segcore.parts(sheet, [0, 1]).parts[0].neighbours
    assert neighbour.plane is None
    assert neighbour.length == pytest.approx(2**0.5)


def test_bodies_that_only_touch_are_no_neighbours() -> None:
    two = shapes.joined(shapes.box(), shapes.box((0.5, 0.5, 0.5), (0.75, 0.0, 0.0)))
    assert [part.neighbours for part in segcore.parts(two.mesh, two.parts).parts] == [(), ()]


def test_neighbours_share_a_border_of_one_length() -> None:
    shape = shapes.burr(4)
    parts = segcore.parts(shape.mesh, shape.parts).parts
    lengths = {(part.number, other.part): other.length for part in parts for other in part.neighbours}
    assert set(lengths) == {pair for arm in range(1, 7) for pair in ((0, arm), (arm, 0))}
    assert all(lengths[a, b] == lengths[b, a] > 0.0 for a, b in lengths)
