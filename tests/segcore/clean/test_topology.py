from collections import Counter
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst

from segcore import shapes
from segcore.clean.topology import (
    as_bits,
    border_vertices,
    consistent_orientation,
    dual_edges,
    first_equal_row,
    mesh_edges,
)
from segcore.graphs.surface_graph import connected_components, rows_of


def any_faces(largest: int = 6) -> st.SearchStrategy[np.ndarray]:
    """(F, 3) faces over a few vertices, with repeated corners and edges of many faces."""
    return npst.arrays(np.int32, st.tuples(st.integers(1, 15), st.just(3)), elements=st.integers(0, largest))


def half_edges(faces: np.ndarray) -> list[tuple[int, int, int]]:
    """The face, start and end of every half-edge."""
    return [(f, face[k], face[(k + 1) % 3]) for f, face in enumerate(faces.tolist()) for k in range(3)]


@given(npst.arrays(np.int64, st.tuples(st.integers(0, 40), st.just(3)), elements=st.integers(-2, 2)))
def test_first_equal_row_agrees_with_numpy(rows):
    _, first, which = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    np.testing.assert_array_equal(first_equal_row(rows), first[which.ravel()] if len(rows) else [])


@given(any_faces())
def test_dual_edges_agree_with_a_dictionary_of_edges(faces):
    at_edge: dict[tuple[int, int], list[tuple[int, bool]]] = {}
    for f, a, b in half_edges(faces):
        at_edge.setdefault((min(a, b), max(a, b)), []).append((f, a < b))
    expected = sorted((f, g, *edge, len(at) == 2, f_forward == g_forward) for edge, at in at_edge.items()
                      for (f, f_forward), (g, g_forward) in pairwise(at) if f != g)  # fmt: skip
    dual = dual_edges(faces, 7)
    found = sorted((*f, *e, m, d) for f, e, m, d in zip(*(field.tolist() for field in dual), strict=True))
    assert found == expected


@given(any_faces())
def test_border_vertices_are_the_ends_of_edges_of_one_face(faces):
    uses = Counter((min(a, b), max(a, b)) for _, a, b in half_edges(faces) if a != b)
    expected = {vertex for edge, count in uses.items() if count == 1 for vertex in edge}
    assert set(np.flatnonzero(border_vertices(faces, 7)).tolist()) == expected


@pytest.mark.parametrize("seed", range(5))
def test_edges_of_vertices_with_very_many_faces_are_found_as_well(seed):
    faces = np.random.default_rng(seed).integers(0, 7, (300, 3), dtype=np.int32)
    test_dual_edges_agree_with_a_dictionary_of_edges.hypothesis.inner_test(faces)
    test_border_vertices_are_the_ends_of_edges_of_one_face.hypothesis.inner_test(faces)
    fan = np.array([[0, 1 + k, 2 + k] for k in np.random.default_rng(seed).permutation(100)], dtype=np.int32)
    assert border_vertices(fan, 102).all()
    assert len(dual_edges(fan, 102).faces) == 99


@given(any_faces())
def test_mesh_edges_are_the_distinct_pairs_of_corners_in_order(faces):
    expected = sorted({(min(a, b), max(a, b)) for _, a, b in half_edges(faces) if a != b})
    assert [tuple(edge) for edge in mesh_edges(faces).tolist()] == expected


@given(any_faces())
def test_patches_are_the_components_over_edges_of_exactly_two_faces(faces):
    dual = dual_edges(faces, 7)
    patch, is_flipped = consistent_orientation(rows_of(dual.faces, len(faces)), dual)
    np.testing.assert_array_equal(patch, connected_components(dual.faces[dual.is_manifold], len(faces)))
    _, first = np.unique(patch, return_index=True)
    assert not is_flipped[first].any()


@pytest.mark.parametrize("seed", range(3))
def test_flips_make_the_faces_of_orientable_patches_agree(seed):
    mesh = shapes.joined(shapes.burr(3).mesh, shapes.box(centre=(5, 0, 0))).mesh
    turned = np.random.default_rng(seed).random(len(mesh.faces)) < 0.5
    faces = np.where(turned[:, None], mesh.faces[:, [0, 2, 1]], mesh.faces)
    dual = dual_edges(faces, len(mesh.vertices))
    assert dual.is_manifold.all()
    _, is_flipped = consistent_orientation(rows_of(dual.faces, len(faces)), dual)
    oriented = np.where(is_flipped[:, None], faces[:, [0, 2, 1]], faces)
    assert not dual_edges(oriented, len(mesh.vertices)).disagrees.any()


def test_both_zeros_have_the_same_bits_and_other_numbers_their_own():
    bits = as_bits(np.array([[0.0, -0.0, 1.0], [-1.0, np.nextafter(1.0, 2.0), 1.0]]))
    assert bits[0, 0] == bits[0, 1]
    assert len(np.unique(bits)) == 4
