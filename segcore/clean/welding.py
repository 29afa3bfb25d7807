"""Welding of vertices at the same place, at open borders also within a tolerance."""

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from segcore.arrays import BoolArray, FloatArray, IntArray
from segcore.clean.topology import as_bits, border_vertices, first_equal_row, mixed_bits
from segcore.jit.decorators import kernel

WELD_TOLERANCE = 1e-6  # of the extent of the mesh: the resolution of numbers that are written with six digits
_CELL = 16.0  # of the grid in which near points are looked for, in tolerances; set by hand
_SLOTS = 16  # of the table of its cells, for every point; set by hand


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
    joined = np.arange(len(points), dtype=np.int32)
    near = np.flatnonzero(_may_be_near(points - points.min(axis=0), tolerance))
    if len(near) == 0:
        return joined
    pairs = KDTree(points[near]).query_pairs(tolerance, output_type="ndarray")
    graph = coo_array((np.ones(len(pairs), dtype=bool), (pairs[:, 0], pairs[:, 1])), shape=(len(near), len(near)))
    _, group = connected_components(graph, directed=False)
    _, first = np.unique(group, return_index=True)
    joined[near] = near[first[group]]
    return joined


@kernel
def _may_be_near(points: FloatArray, tolerance: float) -> BoolArray:
    """(N,) False for points without another one within the tolerance, though not for all of them.

    Around every point is a box of twice the tolerance in every direction, and two points whose boxes have no cell of a
    grid in common are not near. Cells are counted in a table by a hash of their place; others may have the same slot.

    Parameters
    ----------
    points : (N, 3) >= 0.
    """
    if tolerance <= 0.0:
        return np.ones(len(points), np.bool_)
    slots = 16
    while slots < _SLOTS * len(points):
        slots *= 2
    touched = np.zeros(slots, np.uint8)
    near = np.zeros(len(points), np.bool_)
    place = np.empty((2, 3), np.int64)
    for is_counted in (False, True):
        for i in range(len(points)):
            for axis in range(3):
                place[0, axis] = int((points[i, axis] - 2.0 * tolerance) / (_CELL * tolerance) + 1.0)
                place[1, axis] = int((points[i, axis] + 2.0 * tolerance) / (_CELL * tolerance) + 1.0)
            for x in range(place[0, 0], place[1, 0] + 1):
                for y in range(place[0, 1], place[1, 1] + 1):
                    for z in range(place[0, 2], place[1, 2] + 1):
                        key = mixed_bits(mixed_bits(mixed_bits(np.uint64(x)) + np.uint64(y)) + np.uint64(z))
                        slot = key & np.uint64(slots - 1)
                        if is_counted:
                            near[i] |= touched[slot] > 1
                        else:
                            touched[slot] = min(touched[slot] + 1, 2)
    return near


def _of_lost_corners(candidate: IntArray, faces: IntArray) -> BoolArray:
    """(V,) True for the vertices of groups that contain two corners of one face."""
    moved = candidate[faces]
    lost = np.zeros(len(candidate), dtype=bool)
    for a, b in ((0, 1), (1, 2), (2, 0)):
        merged = (moved[:, a] == moved[:, b]) & (faces[:, a] != faces[:, b])
        lost[moved[merged, a]] = True
    of_group: BoolArray = lost[candidate]
    return of_group
