from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst

from helpers.meshes import exploded
from segcore import shapes
from segcore.clean.orientation import patch_volumes, reliable_normals, turned_round
from segcore.clean.surface import build_surface
from segcore.clean.topology import dual_edges, first_equal_row
from segcore.mesh import Mesh, face_normals_and_areas


@given(npst.arrays(np.int64, st.tuples(st.integers(0, 40), st.just(3)), elements=st.integers(-2, 2)))
def test_first_equal_row_agrees_with_numpy(rows):
    _, first, which = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    np.testing.assert_array_equal(first_equal_row(rows), first[which.ravel()] if len(rows) else [])


@given(npst.arrays(np.int32, st.tuples(st.integers(1, 15), st.just(3)), elements=st.integers(0, 6)))
def test_dual_edges_agree_with_a_dictionary_of_edges(faces):
    at_edge: dict[tuple[int, int], list[int]] = {}
    for f, face in enumerate(faces.tolist()):
        for k in range(3):
            at_edge.setdefault(tuple(sorted((face[k], face[(k + 1) % 3]))), []).append(f)
    expected = sorted((f, g, *edge, len(at) == 2) for edge, at in at_edge.items()
                      for f, g in pairwise(at) if f != g)  # fmt: skip
    pairs, ends, manifold, _ = dual_edges(faces, 7)
    found = sorted((*p, *e, m) for p, e, m in zip(pairs.tolist(), ends.tolist(), manifold.tolist(), strict=True))
    assert found == expected


def test_a_soup_of_triangles_is_welded_into_the_surface_it_came_from():
    whole, soup = shapes.icosphere(2), exploded(shapes.icosphere(2))
    assert len(build_surface(soup).vertices) == len(whole.vertices)
    assert len(build_surface(soup).edge_faces) == 3 * len(whole.faces) // 2


@pytest.mark.parametrize("seed", range(3))
def test_faces_are_turned_outward_whatever_way_they_came(seed):
    sphere = shapes.icosphere(2)
    turn = np.random.default_rng(seed).random(len(sphere.faces)) < 0.5
    faces = np.where(turn[:, None], sphere.faces[:, ::-1], sphere.faces)
    surface = build_surface(Mesh(sphere.vertices, faces))
    outward = np.einsum("ij,ij->i", surface.normals, surface.vertices[surface.faces].mean(axis=1))
    assert outward.min() > 0


def test_every_component_is_turned_outward_by_itself():
    inside_out = Mesh(shapes.icosphere(1).vertices + 5, shapes.icosphere(1).faces[:, ::-1])
    surface = build_surface(shapes.joined(shapes.icosphere(1), inside_out).mesh)
    middle = np.repeat([[0.0, 0, 0], [5.0, 5, 5]], 80, axis=0)
    at = surface.vertices[surface.faces].mean(axis=1) * surface.unit + 2.5
    assert np.einsum("ij,ij->i", surface.normals, at - middle).min() > 0


def test_repeated_faces_and_faces_without_three_corners_follow_a_face_that_stands_for_them():
    box = shapes.box()
    extra = [box.faces[4], box.faces[4][[1, 0, 2]], [box.faces[4][0]] * 2 + [box.faces[4][1]], [7, 7, 7]]
    surface = build_surface(Mesh(box.vertices, np.concatenate([box.faces, extra])))
    assert len(surface.faces) == 12
    np.testing.assert_array_equal(surface.face_of_input[:12], np.arange(12))
    np.testing.assert_array_equal(surface.face_of_input[12:14], [4, 4])
    assert set(box.faces[4][:2]) <= set(box.faces[surface.face_of_input[14]])
    assert 7 in box.faces[surface.face_of_input[15]]


def test_faces_that_all_lack_a_corner_are_stood_for_by_the_first():
    surface = build_surface(Mesh([[1.0, 2, 3], [4, 5, 6]], [[0, 0, 1], [1, 1, 1], [0, 1, 0]]))
    np.testing.assert_array_equal(surface.face_of_input, [0, 0, 0])


@settings(max_examples=50)
@given(npst.arrays(np.int32, st.tuples(st.integers(1, 12), st.just(3)), elements=st.integers(0, 5)), st.data())
def test_any_faces_make_a_surface_that_stands_for_all_of_them(faces, data):
    vertices = data.draw(npst.arrays(np.float64, (6, 3), elements=st.sampled_from([0.0, -0.0, 1.0, 2.0, 1e-30, 1e30])))
    surface = build_surface(Mesh(vertices, faces))
    assert surface.face_of_input.min() >= 0
    assert surface.face_of_input.max() < len(surface.faces)
    assert np.isfinite(surface.normals).all()
    assert np.isfinite(surface.areas).all()


def test_normals_and_areas_agree_with_numpy():
    mesh = shapes.burr(3).mesh
    normals, areas = reliable_normals(mesh.vertices, mesh.faces)
    expected_normals, expected_areas = face_normals_and_areas(mesh.corners)
    np.testing.assert_allclose(normals, expected_normals, atol=1e-12)
    np.testing.assert_allclose(areas, expected_areas)


def test_a_patch_encloses_its_volume_wherever_it_is_and_minus_that_when_turned_round():
    mesh = shapes.box((1, 2, 3), (50, -20, 7))
    patch, turned = np.zeros(12, np.int32), np.zeros(12, bool)
    area, volume = patch_volumes(mesh.vertices, mesh.faces, patch, turned, 1)
    np.testing.assert_allclose(area, 22)
    np.testing.assert_allclose(volume, 6)
    np.testing.assert_allclose(patch_volumes(mesh.vertices, mesh.faces, patch, ~turned, 1)[1], -6)
    np.testing.assert_array_equal(turned_round(mesh.faces, ~turned), mesh.faces[:, [0, 2, 1]])
