import numpy as np
import pytest

from segcore import shapes
from segcore.clean.orientation import flipped, patch_volumes, reliable_normals
from segcore.mesh import face_normals_and_areas


def test_normals_and_areas_agree_with_numpy():
    mesh = shapes.burr(3).mesh
    normals, areas = reliable_normals(mesh.vertices, mesh.faces)
    expected_normals, expected_areas = face_normals_and_areas(mesh.corners)
    np.testing.assert_allclose(normals, expected_normals, atol=1e-12)
    np.testing.assert_allclose(areas, expected_areas)


def test_slivers_have_an_area_and_no_normal():
    vertices = np.array([[0.0, 0, 0], [1, 0, 0], [0.5, 1e-7, 0], [0.5, 1e-5, 0]])
    normals, areas = reliable_normals(vertices, np.array([[0, 1, 2], [0, 1, 3]], np.int32))
    np.testing.assert_array_equal(normals, [[0, 0, 0], [0, 0, 1]])
    np.testing.assert_allclose(areas, [0.5e-7, 0.5e-5])


def test_a_patch_encloses_its_volume_at_any_place_and_minus_that_if_it_is_flipped():
    mesh = shapes.box((1, 2, 3), (50, -20, 7))
    patch, is_flipped = np.zeros(12, np.int32), np.zeros(12, bool)
    area, volume = patch_volumes(mesh.vertices, mesh.faces, patch, is_flipped, 1)
    np.testing.assert_allclose(area, 22)
    np.testing.assert_allclose(volume, 6)
    np.testing.assert_allclose(patch_volumes(mesh.vertices, mesh.faces, patch, ~is_flipped, 1)[1], -6)
    np.testing.assert_array_equal(flipped(mesh.faces, ~is_flipped), mesh.faces[:, [0, 2, 1]])


@pytest.mark.parametrize("seed", range(3))
def test_volumes_of_any_patches_are_those_of_cones_to_their_centroids(seed):
    rng = np.random.default_rng(seed)
    mesh = shapes.burr(3).mesh
    patch = rng.integers(0, 5, len(mesh.faces)).astype(np.int32)
    is_flipped = rng.random(len(mesh.faces)) < 0.3
    area, volume = patch_volumes(mesh.vertices, mesh.faces, patch, is_flipped, 5)
    corners = mesh.vertices[flipped(mesh.faces, is_flipped)]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas, centroids = 0.5 * np.linalg.norm(cross, axis=1), corners.mean(axis=1)
    for p in range(5):
        own = patch == p
        apex = np.average(centroids[own], axis=0, weights=areas[own])
        np.testing.assert_allclose(area[p], areas[own].sum())
        expected = np.einsum("ij,ij->", centroids[own] - apex, cross[own]) / 6
        np.testing.assert_allclose(volume[p], expected, atol=1e-12)
