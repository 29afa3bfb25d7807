import numpy as np
import pytest

from segcore import shapes
from segcore.affinity.patches import COUNT, patches_of
from segcore.clean.edge_geometry import EdgeGeometry
from segcore.clean.surface import build_surface
from segcore.graphs.surface_graph import connected_components
from segcore.mesh import Mesh


def patches(mesh, seed=0):
    """The surface of a mesh, and its patches with affinity 1 everywhere."""
    surface = build_surface(mesh)
    length = EdgeGeometry.of(surface).positive_length
    return surface, patches_of(surface, np.ones(len(length)), length, np.random.default_rng(seed))


def sheet(columns):
    x, y = np.meshgrid(np.linspace(0, 1, columns + 1), np.linspace(0, 1, columns + 1), indexing="ij")
    corner = (np.arange(columns)[:, None] * (columns + 1) + np.arange(columns)).ravel()
    right, above = corner + columns + 1, corner + 1
    faces = np.concatenate([np.column_stack([corner, right, right + 1]), np.column_stack([corner, right + 1, above])])
    return Mesh(np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)]), faces)


@pytest.mark.parametrize("subdivisions", [2, 5])
def test_patches_are_connected_alike_in_size_and_cover_the_surface(subdivisions):
    surface, made = patches(shapes.icosphere(subdivisions))
    assert len(made.area) == min(COUNT, len(surface.faces))
    np.testing.assert_allclose(made.area, np.bincount(made.of_face, surface.areas))
    inside = made.of_face[surface.edge_faces[:, 0]] == made.of_face[surface.edge_faces[:, 1]]
    components = connected_components(surface.edge_faces[inside], len(surface.faces))
    assert components.max() + 1 == len(made.area)
    assert made.area.max() < 2.1 * made.area.mean()
    assert made.area.min() > 0.1 * made.area.mean()


def test_smoothing_keeps_the_mean_and_flattens():
    _, made = patches(shapes.icosphere(5))
    values = np.random.default_rng(0).normal(size=len(made.area))
    smooth = made.smoothed(values, 0.1, made.area)
    np.testing.assert_allclose(np.dot(made.area, smooth), np.dot(made.area, values))
    assert smooth.std() < 0.5 * values.std()
    np.testing.assert_allclose(made.smoothed(np.full(len(made.area), 3.0), 0.1, made.area), 3.0)
    np.testing.assert_allclose(made.smoothed(np.stack([values, 2 * values], axis=1), 0.1, made.area)[:, 1], 2 * smooth)


def test_patches_without_mass_take_the_values_around_them():
    _, made = patches(shapes.icosphere(5))
    unknown = np.arange(len(made.area)) % 7 == 0
    values = np.where(unknown, 100.0, made.centre[:, 2])
    smooth = made.smoothed(values, 0.05, np.where(unknown, 1e-9, made.area))
    assert np.abs(smooth - made.centre[:, 2])[unknown].max() < 0.1


def test_the_gradient_of_a_linear_function_on_a_plane_is_its_slope():
    _, made = patches(sheet(60))
    slope = np.array([2.0, -3.0, 0.0])
    gradient = made.gradients(made.centre @ slope)
    np.testing.assert_allclose(gradient, np.tile(slope, (len(made.area), 1)), atol=0.02)


def test_smoothing_solves_the_implicit_step_of_diffusion():
    """(M + r^2 / 6 L) x = M values, with the masses M and the Laplacian L of the conductances border / distance."""
    _, made = patches(shapes.icosphere(2))
    rng = np.random.default_rng(0)
    values, mass = rng.normal(size=(len(made.area), 3)), made.area * rng.random(len(made.area))
    conductance = np.zeros((len(made.area), len(made.area)))
    conductance[tuple(made.pairs.T)] = made.border / made.distance
    conductance += conductance.T
    matrix = np.diag(mass) + 0.3**2 / 6 * (np.diag(conductance.sum(axis=1)) - conductance)
    np.testing.assert_allclose(made.smoothed(values, 0.3, mass), np.linalg.solve(matrix, mass[:, None] * values))


def test_masses_that_vanish_beside_the_exchange_still_give_their_mean():
    _, made = patches(shapes.icosphere(5))
    values = np.random.default_rng(0).normal(size=(len(made.area), 2))
    mean = np.average(values, axis=0, weights=made.area)
    np.testing.assert_allclose(
        made.smoothed(values, 2.0, 1e-40 * made.area), np.tile(mean, (len(values), 1)), atol=1e-6
    )
