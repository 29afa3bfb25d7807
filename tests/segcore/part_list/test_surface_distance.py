"""Distances of points from parts, against trimesh."""

import numpy as np
import trimesh

from helpers.part_list.copies import hand
from segcore.mesh import Mesh
from segcore.part_list.surface_distance import SurfaceDistance, distances_from_triangles


def exact(points: np.ndarray, mesh: Mesh) -> np.ndarray:
    """The least distance of every point from any face."""
    every = np.repeat(points, len(mesh.faces), axis=0)
    corners = np.tile(mesh.corners, (len(points), 1, 1))
    nearest = trimesh.triangles.closest_point(corners, every)
    return np.linalg.norm(nearest - every, axis=1).reshape(len(points), -1).min(axis=1)


def test_the_distance_from_a_triangle_is_that_of_trimesh() -> None:
    rng = np.random.default_rng(0)
    points, corners = rng.normal(size=(500, 3)), rng.normal(size=(500, 3, 3))
    nearest = trimesh.triangles.closest_point(corners, points)
    np.testing.assert_allclose(
        distances_from_triangles(points, corners), np.linalg.norm(nearest - points, axis=1), atol=1e-12
    )


def test_the_distance_from_a_degenerate_triangle_is_that_from_its_edges() -> None:
    line = np.array([[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]])
    assert distances_from_triangles(np.array([[1.5, 3.0, 4.0]]), line).tolist() == [5.0]
    assert distances_from_triangles(np.array([[0.0, 3.0, 4.0]]), np.zeros((1, 3, 3))).tolist() == [5.0]


def test_the_distance_from_a_body_is_the_least_one_from_its_faces() -> None:
    mesh = hand()
    points = np.random.default_rng(1).uniform(-3.0, 3.0, size=(300, 3))
    found = SurfaceDistance(mesh.vertices, mesh.faces)(points)
    wanted = exact(points, mesh)
    assert (found >= wanted - 1e-12).all()
    np.testing.assert_allclose(found, wanted, atol=0.01)
    assert np.isclose(found, wanted).mean() > 0.95
