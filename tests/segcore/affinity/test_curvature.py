import numpy as np
import pytest

from segcore import shapes
from segcore.affinity.curvature import principal_curvatures


@pytest.mark.parametrize("radius", [0.1, 1.0, 30.0])
def test_both_curvatures_of_a_sphere_are_one_over_its_radius(radius):
    sphere = shapes.icosphere(4, radius)
    curvature = principal_curvatures(sphere.vertices, sphere.faces)
    np.testing.assert_allclose(curvature.k1, 1 / radius, rtol=1e-3)
    np.testing.assert_allclose(curvature.k2, 1 / radius, rtol=1e-3)


def test_inside_out_changes_the_signs():
    sphere = shapes.icosphere(3)
    curvature = principal_curvatures(sphere.vertices, sphere.faces[:, ::-1])
    np.testing.assert_allclose(curvature.k2, -1, rtol=1e-2)


def test_a_torus_has_the_curvatures_of_the_closed_form():
    u, v = np.meshgrid(np.arange(160), np.arange(80), indexing="ij")
    a, b = 2 * np.pi * u.ravel() / 160, 2 * np.pi * v.ravel() / 80
    ring = 1 + 0.3 * np.cos(b)
    vertices = np.stack([ring * np.cos(a), ring * np.sin(a), 0.3 * np.sin(b)], axis=1)
    at = lambda i, j: (i % 160) * 80 + j % 80  # noqa: E731
    p, q, r, s = at(u, v), at(u + 1, v), at(u + 1, v + 1), at(u, v + 1)
    faces = np.concatenate([np.stack([p, q, r], -1).reshape(-1, 3), np.stack([p, r, s], -1).reshape(-1, 3)])
    curvature = principal_curvatures(vertices, faces.astype(np.int32))
    np.testing.assert_allclose(curvature.k1, 1 / 0.3, rtol=0.01)
    np.testing.assert_allclose(curvature.k2, np.cos(b) / ring, atol=0.02)


def test_a_cylinder_is_curved_one_way_only():
    tube = shapes.revolve(np.full(40, 0.5), np.linspace(-4, 4, 40), 64)
    curvature = principal_curvatures(tube.vertices, tube.faces)
    middle = np.abs(tube.vertices[:, 2]) < 3
    np.testing.assert_allclose(curvature.k1[middle], 2, rtol=0.01)
    np.testing.assert_allclose(curvature.k2[middle], 0, atol=0.01)


def test_values_at_slivers_are_finite():
    vertices = np.array([[0.0, 0, 0], [1, 0, 0], [0.5, 0, 0], [0.5, 1e-12, 0], [0, 1, 0]])
    faces = np.array([[0, 1, 2], [0, 1, 3], [0, 1, 4]], np.int32)
    curvature = principal_curvatures(vertices, faces)
    assert np.isfinite(curvature.k1).all()
    assert np.isfinite(curvature.k2).all()
