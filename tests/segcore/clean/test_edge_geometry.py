import numpy as np
import pytest

from segcore import shapes
from segcore.clean.edge_geometry import EdgeGeometry, across_edges, dihedral_angles, edge_lengths
from segcore.clean.surface import build_surface
from segcore.mesh import Mesh

NOISY = shapes.burr(3).mesh
NOISE = np.random.default_rng(0).normal(scale=0.02, size=NOISY.vertices.shape)
SURFACES = {"noisy burr": build_surface(Mesh(NOISY.vertices + NOISE, NOISY.faces)), "box": build_surface(shapes.box())}
any_surface = pytest.mark.parametrize("surface", SURFACES.values(), ids=SURFACES)


@any_surface
def test_lengths_agree_with_numpy(surface):
    ends = surface.vertices[surface.edge_vertices]
    np.testing.assert_allclose(edge_lengths(surface), np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1))


@any_surface
def test_dihedral_angles_agree_with_numpy(surface):
    n, m = surface.normals[surface.edge_faces].transpose(1, 0, 2)
    first, second = surface.vertices[surface.faces[surface.edge_faces]].mean(axis=2).transpose(1, 0, 2)
    angle = np.arctan2(np.linalg.norm(np.cross(n, m), axis=1), np.einsum("ij,ij->i", n, m))
    is_concave = np.einsum("ij,ij->i", n, second - first) > 0
    np.testing.assert_allclose(dihedral_angles(surface), np.where(is_concave, -angle, angle), atol=1e-7)


@any_surface
def test_directions_across_edges_agree_with_numpy(surface):
    ends = surface.vertices[surface.edge_vertices]
    cross = np.cross(ends[:, 1] - ends[:, 0], surface.normals[surface.edge_faces].sum(axis=1))
    expected = cross / np.linalg.norm(cross, axis=1, keepdims=True)
    np.testing.assert_allclose(across_edges(surface), expected, atol=1e-12)


def test_an_edge_at_a_sliver_without_a_normal_is_flat():
    mesh = Mesh([[0.0, 0, 0], [1, 0, 0], [0.5, 1e-9, 0], [0.5, 0, 1]], [[0, 1, 2], [1, 0, 3]])
    np.testing.assert_array_equal(dihedral_angles(build_surface(mesh)), [0.0])


def test_an_edge_without_a_length_has_no_direction_and_a_positive_length():
    mesh = Mesh([[0.0, 0, 0], [1e-300, 0, 0], [0, 1, 0], [0, -1, 0]], [[0, 1, 2], [1, 0, 3]])
    surface = build_surface(mesh)
    geometry = EdgeGeometry.of(surface)
    np.testing.assert_array_equal(across_edges(surface), [[0, 0, 0]])
    assert geometry.positive_length.min() > 0


def test_the_typical_dihedral_angle_is_the_mean_weighted_by_length():
    surface = SURFACES["noisy burr"]
    expected = np.average(np.abs(dihedral_angles(surface)), weights=edge_lengths(surface))
    assert EdgeGeometry.of(surface).typical_dihedral == pytest.approx(expected)


def test_the_typical_dihedral_angle_of_a_plane_is_positive():
    plane = Mesh([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    assert EdgeGeometry.of(build_surface(plane)).typical_dihedral > 0
