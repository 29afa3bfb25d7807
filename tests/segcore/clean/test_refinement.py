import numpy as np
import pytest

from segcore import shapes
from segcore.clean.refinement import refine, undivided
from segcore.clean.surface import build_surface
from segcore.mesh import Mesh

PROFILE = build_surface(shapes.box((10, 1, 0.5)))
FAN = build_surface(
    Mesh([[0.0, 0, 0], [0, 0, 1], [9, 0, 0], [0, 9, 0], [-5, -7, 0]], [[0, 1, 2], [0, 1, 3], [0, 1, 4]])
)
coarse = pytest.mark.parametrize("surface", [PROFILE, FAN, build_surface(shapes.icosphere(0))])


def lengths(surface):
    corners = surface.vertices[surface.faces]
    return np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2)


@coarse
def test_pieces_tile_their_face(surface):
    refined = refine(surface)
    assert len(refined.parent) > 10 * len(surface.faces)
    np.testing.assert_allclose(np.bincount(refined.parent, refined.surface.areas), surface.areas)
    corners = refined.surface.vertices[refined.surface.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    np.testing.assert_allclose(normals, surface.normals[refined.parent], atol=1e-9)
    np.testing.assert_array_equal(refined.surface.normals, surface.normals[refined.parent])


@coarse
def test_no_edge_stays_long(surface):
    """Edges that arise between midpoints may be a little longer than what is allowed."""
    refined = refine(surface)
    assert lengths(refined.surface).max() < 1.1 * 0.06 * np.sqrt(surface.areas.sum())


def test_a_closed_surface_stays_closed():
    """Neighbours share whole edges: no vertex lies in the middle of an edge of the other face."""
    refined = refine(PROFILE).surface
    assert 2 * len(refined.edge_faces) == 3 * len(refined.faces)
    assert len(refined.vertices) - len(refined.edge_faces) + len(refined.faces) == 2


def test_pieces_of_faces_at_a_non_manifold_edge_are_chained_as_the_faces_are():
    refined = refine(FAN)
    parents = refined.parent[refined.surface.edge_faces]
    crossing = {tuple(pair) for pair in np.sort(parents[parents[:, 0] != parents[:, 1]], axis=1).tolist()}
    assert crossing == {tuple(pair) for pair in np.sort(FAN.edge_faces, axis=1).tolist()}


def test_a_fine_mesh_is_left_as_it_is():
    surface = build_surface(shapes.dumbbell().mesh)
    refined = refine(surface)
    assert refined.surface is surface
    assert not refined.is_piece.any()


def test_a_few_long_faces_on_a_fine_mesh_are_left_as_they_are():
    sphere = shapes.icosphere(4)
    spike = np.append(sphere.vertices, [[2.0, 0, 0]], axis=0)
    surface = build_surface(
        Mesh(spike, np.append(sphere.faces, [[*sphere.faces[0, :2], len(sphere.vertices)]], axis=0))
    )
    assert refine(surface).surface is surface


def test_only_components_with_large_faces_are_divided():
    surface = build_surface(shapes.joined(shapes.icosphere(4), shapes.box(centre=(5, 0, 0))).mesh)
    pieces = np.bincount(refine(surface).parent)
    assert (pieces[:-12] == 1).all()
    assert (pieces[-12:] > 10).all()


def test_the_number_of_pieces_is_bounded():
    needles = shapes.joined(*[shapes.box((1000, 1, 1), (0, 3.0 * i, 0)) for i in range(100)]).mesh
    surface = build_surface(needles)
    assert len(surface.faces) < len(refine(surface).parent) <= len(surface.faces) + 20_000


def test_a_surface_without_area_is_left_as_it_is():
    surface = build_surface(Mesh(np.ones((3, 3)), [[0, 1, 2], [0, 0, 0]]))
    assert refine(surface).surface is surface
    np.testing.assert_array_equal(undivided(surface).parent, [0])
