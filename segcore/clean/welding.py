"""Welding of vertices at the same place, at open borders also within a tolerance."""

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from segcore.arrays import BoolArray, FloatArray, IntArray
from segcore.clean.topology import as_bits, border_vertices, first_equal_row

WELD_TOLERANCE = 1e-6  # of the extent of the mesh: the resolution of numbers that are written with six digits


def weld(vertices: FloatArray, faces: IntArray) -> IntArray:
    """(V,) the vertex that replaces every vertex, itself or an earlier one.

    Vertices at exactly the same place become one. Of the vertices on border edges that remain, those within
    ``WELD_TOLERANCE`` of each other become one too, unless a face would lose a corner by that. This joins borders that
    were rounded differently on both sides and leaves a mesh without borders as it is.
    """
    exact = first_equal_row(as_bits(vertices))
    border = np.flatnonzero(border_vertices(exact[faces], len(vertices))).astype(np.int32)
    if len(border) < 2:
        return exact
    used = vertices[exact[faces]]
    tolerance = WELD_TOLERANCE * float((used.max(axis=(0, 1)) - used.min(axis=(0, 1))).max())
    joined = _joined(vertices[border], tolerance)
    if (joined == np.arange(len(border))).all():
        return exact
    candidate = np.arange(len(vertices), dtype=np.int32)
    candidate[border] = border[joined]
    candidate[_of_lost_corners(candidate, exact[faces])] = -1
    kept = np.where(candidate < 0, np.arange(len(vertices)), candidate).astype(np.int32)
    welded: IntArray = kept[exact]
    return welded


def _joined(points: FloatArray, tolerance: float) -> IntArray:
    """(N,) the first point of the group of points that are connected by steps within the tolerance."""
    pairs = KDTree(points).query_pairs(tolerance, output_type="ndarray")
    count = len(points)
    graph = coo_array((np.ones(len(pairs), dtype=bool), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    _, group = connected_components(graph, directed=False)
    _, first = np.unique(group, return_index=True)
    return first[group].astype(np.int32)


def _of_lost_corners(candidate: IntArray, faces: IntArray) -> BoolArray:
    """(V,) True for the vertices of groups that contain two corners of one face."""
    moved = candidate[faces]
    lost = np.zeros(len(candidate), dtype=bool)
    for a, b in ((0, 1), (1, 2), (2, 0)):
        merged = (moved[:, a] == moved[:, b]) & (faces[:, a] != faces[:, b])
        lost[moved[merged, a]] = True
    of_group: BoolArray = lost[candidate]
    return of_group
