"""Voxel models: steps are no creases."""

import numpy as np
import pytest

from segcore import Mesh, build_surface, segment
from segcore.clean.voxels import without_voxel_steps
from segcore.shapes import box, icosphere


def voxel_model(filled):
    """The faces between filled and empty cubes of a grid (X, Y, Z), two triangles each, without shared vertices."""
    corners, padded = [], np.pad(filled, 1)
    for axis in range(3):
        for step in (-1, 1):
            empty = ~np.roll(padded, -step, axis)[1:-1, 1:-1, 1:-1]
            square = np.zeros((4, 3))
            square[:, axis] = max(step, 0)
            square[[1, 2], (axis + 1) % 3] = 1
            square[[2, 3], (axis + 2) % 3] = 1
            corners.append(np.argwhere(filled & empty)[:, None] + (square if step > 0 else square[::-1]))
    vertices = np.concatenate(corners).reshape(-1, 3)
    first = np.arange(0, len(vertices), 4)[:, None]
    return Mesh(vertices, (first[:, :, None] + np.array([[0, 1, 2], [0, 2, 3]])).reshape(-1, 3))


def grid(count):
    axis = np.linspace(-1, 1, count)
    return np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1)


def ball(places, centre, radius):
    return ((places - centre) ** 2).sum(axis=-1) < radius**2


@pytest.mark.parametrize("count", [12, 16, 24, 32, 48])
def test_a_ball_of_voxels_is_one_part(count):
    assert segment(voxel_model(ball(grid(count), 0.0, 0.95))).automatic_segments == 1


@pytest.mark.parametrize("count", [16, 24])
def test_a_dumbbell_of_voxels_is_two_balls_and_a_bar(count):
    places = grid(count)
    bar = (np.abs(places[..., 1:]) < 0.12).all(axis=-1) & (np.abs(places[..., 0]) < 0.6)
    mesh = voxel_model(ball(places, [0.6, 0, 0], 0.35) | ball(places, [-0.6, 0, 0], 0.35) | bar)
    labels = segment(mesh).labels(3)
    side = np.sign(np.round(mesh.corners.mean(axis=1)[:, 0] - (count - 1) / 2 - 0.5))
    assert segment(mesh).automatic_segments == 3
    sizes = np.bincount(labels)
    assert sizes.min() < 0.15 * sizes.sum()
    for large in np.argsort(sizes)[1:]:
        assert len(np.unique(side[labels == large])) == 1


def test_only_voxel_models_are_smoothed():
    block = voxel_model(np.ones((5, 6, 7), bool))
    for mesh in (block, icosphere(3), box()):
        surface = build_surface(mesh)
        assert without_voxel_steps(surface) is surface


def test_smoothing_keeps_the_size_and_the_place():
    surface = build_surface(voxel_model(ball(grid(24), 0.0, 0.95)))
    smooth = without_voxel_steps(surface)
    assert smooth is not surface
    np.testing.assert_allclose(smooth.vertices.mean(axis=0), surface.vertices.mean(axis=0), atol=1e-3)
    radius = np.linalg.norm(smooth.vertices, axis=1)
    assert radius.std() < 0.5 * np.linalg.norm(surface.vertices, axis=1).std()
    assert radius.mean() == pytest.approx(np.linalg.norm(surface.vertices, axis=1).mean(), rel=0.03)
