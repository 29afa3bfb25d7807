import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst

from helpers.meshes import exploded
from segcore import shapes
from segcore.clean.surface import build_surface
from segcore.mesh import Mesh


def test_a_soup_of_triangles_is_welded_into_the_surface_it_came_from():
    whole, soup = shapes.icosphere(2), exploded(shapes.icosphere(2))
    assert len(build_surface(soup).vertices) == len(whole.vertices)
    assert len(build_surface(soup).edge_faces) == 3 * len(whole.faces) // 2


@pytest.mark.parametrize("seed", range(3))
def test_faces_are_oriented_outward_from_any_orientation(seed):
    sphere = shapes.icosphere(2)
    turn = np.random.default_rng(seed).random(len(sphere.faces)) < 0.5
    faces = np.where(turn[:, None], sphere.faces[:, ::-1], sphere.faces)
    surface = build_surface(Mesh(sphere.vertices, faces))
    outward = np.einsum("ij,ij->i", surface.normals, surface.vertices[surface.faces].mean(axis=1))
    assert outward.min() > 0


def test_every_component_is_oriented_outward_by_itself():
    inside_out = Mesh(shapes.icosphere(1).vertices + 5, shapes.icosphere(1).faces[:, ::-1])
    surface = build_surface(shapes.joined(shapes.icosphere(1), inside_out).mesh)
    middle = np.repeat([[0.0, 0, 0], [5.0, 5, 5]], 80, axis=0)
    at = surface.vertices[surface.faces].mean(axis=1) * surface.unit + 2.5
    assert np.einsum("ij,ij->i", surface.normals, at - middle).min() > 0


def test_repeated_faces_and_faces_without_three_corners_are_represented_by_a_face_nearby():
    box = shapes.box()
    extra = [box.faces[4], box.faces[4][[1, 0, 2]], [box.faces[4][0]] * 2 + [box.faces[4][1]], [7, 7, 7]]
    surface = build_surface(Mesh(box.vertices, np.concatenate([box.faces, extra])))
    assert len(surface.faces) == 12
    np.testing.assert_array_equal(surface.face_of_input[:12], np.arange(12))
    np.testing.assert_array_equal(surface.face_of_input[12:14], [4, 4])
    assert set(box.faces[4][:2]) <= set(box.faces[surface.face_of_input[14]])
    assert 7 in box.faces[surface.face_of_input[15]]


def test_faces_that_all_lack_a_corner_are_represented_by_the_first():
    surface = build_surface(Mesh([[1.0, 2, 3], [4, 5, 6]], [[0, 0, 1], [1, 1, 1], [0, 1, 0]]))
    np.testing.assert_array_equal(surface.face_of_input, [0, 0, 0])


@settings(max_examples=50)
@given(npst.arrays(np.int32, st.tuples(st.integers(1, 12), st.just(3)), elements=st.integers(0, 5)), st.data())
def test_any_faces_make_a_surface_that_represents_all_of_them(faces, data):
    vertices = data.draw(npst.arrays(np.float64, (6, 3), elements=st.sampled_from([0.0, -0.0, 1.0, 2.0, 1e-30, 1e30])))
    surface = build_surface(Mesh(vertices, faces))
    assert surface.face_of_input.min() >= 0
    assert surface.face_of_input.max() < len(surface.faces)
    assert np.isfinite(surface.normals).all()
    assert np.isfinite(surface.areas).all()
