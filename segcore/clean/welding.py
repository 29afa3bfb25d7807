"""Vertices at the same place, or as near as makes no difference at an open border, taken as one."""

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from segcore.arrays import BoolArray, FloatArray, IntArray
from segcore.clean.topology import as_bits, border_vertices, first_equal_row

WELD_TOLERANCE = 1e-6  # of the extent of the mesh: what numbers written with six digits differ by


def weld(vertices: FloatArray, faces: IntArray) -> IntArray:
    """(V,): the vertex that stands for every vertex, itself or an earlier one.

    Vertices at exactly the same place are one. Of those that are left on border edges, ones within ``WELD_TOLERANCE``
    of each other are one too, unless a face would lose a corner by that: so the halves of a seam that was rounded
    differently on both sides are joined, and a mesh without borders stays as it is.
    """
    stands_for = first_equal_row(as_bits(vertices))
    border = np.flatnonzero(border_vertices(stands_for[faces], len(vertices))).astype(np.int32)
    if len(border) < 2:
        return stands_for
    used = vertices[stands_for[faces]]
    tolerance = WELD_TOLERANCE * float((used.max(axis=(0, 1)) - used.min(axis=(0, 1))).max())
    joined = _joined(vertices[border], tolerance)
    if (joined == np.arange(len(border))).all():
        return stands_for
    candidate = np.arange(len(vertices), dtype=np.int32)
    candidate[border] = border[joined]
    candidate[_of_lost_corners(candidate, stands_for[faces])] = -1
    kept = np.where(candidate < 0, np.arange(len(vertices)), candidate).astype(np.int32)
    welded: IntArray = kept[stands_for]
    return welded


def _joined(points: FloatArray, tolerance: float) -> IntArray:
    """(N,): the first point of the group of points that are joined by steps within the tolerance."""
    pairs = KDTree(points).query_pairs(tolerance, output_type="ndarray")
    count = len(points)
    graph = coo_array((np.ones(len(pairs), dtype=bool), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    _, group = connected_components(graph, directed=False)
    _, first = np.unique(group, return_index=True)
    return first[group].astype(np.int32)


def _of_lost_corners(candidate: IntArray, faces: IntArray) -> BoolArray:
    """(V,): the vertices of groups that have two corners of one face."""
    moved = candidate[faces]
    lost = np.zeros(len(candidate), dtype=bool)
    for a, b in ((0, 1), (1, 2), (2, 0)):
        merged = (moved[:, a] == moved[:, b]) & (faces[:, a] != faces[:, b])
        lost[moved[merged, a]] = True
    of_group: BoolArray = lost[candidate]
    return of_group
