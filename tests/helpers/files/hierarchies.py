"""Hierarchies that Hypothesis makes over the faces of a mesh."""

import numpy as np
from hypothesis import strategies as st

from helpers.files.polygon_soups import Soup, triangle_soups
from segcore.hierarchy import Hierarchy
from segcore.mesh import Mesh, face_normals_and_areas


@st.composite
def hierarchies(draw: st.DrawFn, mesh: Mesh) -> Hierarchy:
    """Any tree of cuts over the faces, in any order of the cuts."""
    areas = face_normals_and_areas(mesh.corners)[1]
    faces_of: list[list[int]] = [list(range(len(mesh.faces)))]
    leaves, split_node = {0}, []
    for _ in range(draw(st.integers(0, min(7, len(mesh.faces) - 1)))):
        node = draw(st.sampled_from(sorted(leaf for leaf in leaves if len(faces_of[leaf]) > 1)))
        shuffled = draw(st.permutations(faces_of[node]))
        at = draw(st.integers(1, len(shuffled) - 1))
        parts = sorted([shuffled[:at], shuffled[at:]], key=lambda part: -areas[part].sum())
        leaves = leaves - {node} | {len(faces_of), len(faces_of) + 1}
        split_node.append(node)
        faces_of += parts
    face_leaf = np.zeros(len(mesh.faces), dtype=np.int32)
    for leaf in leaves:
        face_leaf[faces_of[leaf]] = leaf
    cut_values = st.one_of(st.floats(0, 10), st.just(float("inf")))
    return Hierarchy(
        split_node=np.array(split_node, dtype=np.int32),
        cut_value=np.array([draw(cut_values) for _ in split_node], dtype=np.float64),
        area=np.array([areas[faces].sum() for faces in faces_of]),
        face_count=np.array([len(faces) for faces in faces_of], dtype=np.int32),
        face_leaf=face_leaf,
        automatic_segments=draw(st.integers(1, len(leaves))),
    )


def mesh_of(soup: Soup) -> Mesh:
    return Mesh(soup.vertices, soup.triangles)


@st.composite
def segmentations(draw: st.DrawFn) -> tuple[Mesh, Hierarchy, int]:
    """A mesh, a hierarchy over it and a number of segments."""
    mesh = mesh_of(draw(triangle_soups()))
    hierarchy = draw(hierarchies(mesh))
    return mesh, hierarchy, draw(st.integers(1, hierarchy.max_segments))


def two_strips(offset: float = 0.0, size: float = 1.0) -> tuple[Mesh, Hierarchy]:
    """Two flat strips of two faces each, cut apart first and then one of them again."""
    flat = np.array([(x, y, 0.0) for x in (0, 1) for y in range(5)], dtype=np.float64)
    faces = [(y, y + 5, y + 6) if half else (y, y + 6, y + 1) for y in (0, 3) for half in (0, 1)]
    mesh = Mesh(flat * size + offset, faces)
    square = 0.5 * size * size
    hierarchy = Hierarchy(
        split_node=np.array([0, 2], dtype=np.int32),
        cut_value=np.array([0.0, 1.5]),
        area=np.array([4, 2, 2, 1, 1]) * square,
        face_count=np.array([4, 2, 2, 1, 1], dtype=np.int32),
        face_leaf=np.array([1, 3, 1, 4], dtype=np.int32),
        automatic_segments=2,
    )
    return mesh, hierarchy
