"""Closed solids that touch along whole faces with the same corners, as stacked boxes do, are kept apart."""

from typing import NamedTuple

import numpy as np

from segcore.arrays import BoolArray, FloatArray, IntArray, LongArray
from segcore.clean.orientation import patch_volumes
from segcore.clean.topology import first_equal_row, sorted_rows
from segcore.graphs.surface_graph import connected_components
from segcore.mesh import face_normals_and_areas

# Largest relative difference of the areas of the faces of cubes, and of their normals from an axis. Set by hand.
_ALIKE = 1e-3


class _Faces(NamedTuple):
    """The distinct faces of a mesh, of which two at one place that face each other are distinct, too."""

    of_mesh: LongArray  # (N,) their indices
    facing: LongArray  # (P, 2) the faces, 0 to N - 1, that face each other


def with_solids_apart(corners: IntArray, positions: FloatArray) -> tuple[IntArray, FloatArray]:
    """(F, 3) corners in which solids that touch along whole faces have vertices of their own, and all positions.

    If there are none, these are the given arrays.

    Around an edge of several faces, a face belongs to the same solid as the next one on its inner side. A solid is a
    set of faces that are connected in this way, without open edges and with a positive volume. Two of them touch if a
    face of one faces a face of the other at the same place. The two sides of a sheet, or of a body that was modelled
    from inside as well, are no such solids, and the cubes of a voxel model stay together.

    Parameters
    ----------
    corners, positions : (F, 3) and (V, 3) of the mesh.
    """
    faces = _oriented_faces(corners)
    if len(faces.facing) == 0:
        return corners, positions
    triangles = corners[faces.of_mesh]
    normals, areas = face_normals_and_areas(positions[triangles])
    if are_of_cubes(areas, normals):
        return corners, positions
    pairs, is_open = _neighbours(triangles, positions)
    part = connected_components(pairs.astype(np.int32), len(triangles))
    volume = patch_volumes(positions, triangles, part, np.zeros(len(part), dtype=bool), int(part.max()) + 1)[1]
    is_solid = volume > 0.0
    is_solid[part[is_open]] = False
    one, other = part[faces.facing].T
    touch = is_solid[one] & is_solid[other] & (one != other)
    moved = np.isin(part, np.concatenate([one[touch], other[touch]]))
    if not moved.any():
        return corners, positions
    own = part[moved, None].astype(np.int64) * len(positions) + triangles[moved]
    distinct, place = np.unique(own, return_inverse=True)
    apart = corners.copy()
    apart[faces.of_mesh[moved]] = len(positions) + place.reshape(-1, 3)
    return apart, np.concatenate([positions, positions[distinct % len(positions)]])


def are_of_cubes(areas: FloatArray, normals: FloatArray) -> bool:
    """Whether faces with some areas (N,) and normals (N, 3) are halves of squares of one size along the axes."""
    if areas.max() > (1.0 + _ALIKE) * areas.min():
        return False
    return bool(np.abs(normals).max(axis=1).min() >= 1.0 - _ALIKE)


def _oriented_faces(corners: IntArray) -> _Faces:
    """The distinct faces of a mesh, those of two orientations at one place both."""
    a, b, c = corners.T
    proper = np.flatnonzero((a != b) & (b != c) & (c != a))
    first = first_equal_row(sorted_rows(corners, proper))
    chosen = corners[proper]
    least = chosen.argmin(axis=1)
    rows = np.arange(len(chosen))
    turns_back = chosen[rows, (least + 1) % 3] > chosen[rows, (least + 2) % 3]
    key = 2 * first.astype(np.int64) + turns_back
    distinct, index = np.unique(key, return_index=True)
    second = np.flatnonzero(np.diff(distinct // 2, prepend=-1) == 0)  # the other orientation of the one before
    return _Faces(proper[index], np.stack([second - 1, second], axis=1))


def _neighbours(triangles: IntArray, positions: FloatArray) -> tuple[LongArray, BoolArray]:
    """(P, 2) pairs of faces of one solid at an edge, and (N,) True for faces at an edge where no solid is closed."""
    ends = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]).astype(np.int64)
    apex = np.concatenate([triangles[:, 2], triangles[:, 0], triangles[:, 1]])
    owner = np.tile(np.arange(len(triangles)), 3)
    forward = ends[:, 0] < ends[:, 1]
    low, high = ends.min(axis=1), ends.max(axis=1)
    edge = low * len(positions) + high
    order = np.argsort(edge, kind="stable")
    start = np.flatnonzero(np.diff(edge[order], prepend=-1))
    length = np.diff(np.append(start, len(order)))
    pairs = []
    is_open = np.zeros(len(triangles), dtype=bool)
    for k in np.unique(length).tolist():
        half = order[start[length == k][:, None] + np.arange(k)]
        if k > 2:
            half = _around(half, positions[low], positions[high], positions[apex], forward)
        ahead = forward[half]
        alternates = (ahead != np.roll(ahead, -1, axis=1)).all(axis=1) & (k % 2 == 0)
        is_open[owner[half[~alternates]]] = True
        # The inside of a solid begins at a face that runs back along the edge, and ends at one that runs along it.
        begins = ~ahead & alternates[:, None]
        pairs.append(np.stack([owner[half[begins]], owner[np.roll(half, -1, axis=1)[begins]]], axis=1))
    return np.concatenate(pairs), is_open


def _around(half: LongArray, low: FloatArray, high: FloatArray, apex: FloatArray, forward: BoolArray) -> LongArray:
    """(M, K) the half-edges of each edge by their angle around it.

    Of two at one angle, the one whose face runs along the edge comes first.

    Parameters
    ----------
    half : (M, K) the half-edges at M edges.
    low, high, apex, forward : (H, 3) the ends of the edge of every half-edge and the other corner of its face, and (H,)
        whether its face has the lower end first.
    """
    along = high[half] - low[half]
    along /= np.maximum(np.linalg.norm(along, axis=2, keepdims=True), np.finfo(float).tiny)
    across = apex[half] - low[half]
    across -= along * (across * along).sum(axis=2, keepdims=True)
    x = across[:, :1]
    y = np.cross(along[:, :1], x)
    angle = np.arctan2((across * y).sum(axis=2), (across * x).sum(axis=2))
    angle = np.where(angle < 0.0, angle + 2.0 * np.pi, angle)
    sort = np.lexsort((~forward[half], angle), axis=1)
    ordered: LongArray = np.take_along_axis(half, sort, axis=1)
    return ordered
