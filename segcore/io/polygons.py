"""From the polygons of a file to the faces of a mesh."""

from dataclasses import dataclass

import numpy as np

from segcore.appearance import Appearance
from segcore.arrays import BoolArray, FloatArray, IntArray, LongArray
from segcore.io.limits import ReadLimits
from segcore.mesh import Mesh


@dataclass(frozen=True, slots=True, eq=False)
class Polygons:
    """The polygons of a file in its order."""

    corners: LongArray | IntArray  # (sum of sizes,) the vertices of all polygons, one after the other
    sizes: LongArray  # (P,) the number of corners of every polygon, >= 0


def mesh_of_polygons(
    vertices: FloatArray, polygons: Polygons, limits: ReadLimits, appearance: Appearance | None = None
) -> Mesh:
    """A mesh whose faces are the fans of polygons, in their order.

    A polygon with corners c0, c1, ... gives the faces (c0, c1, c2), (c0, c2, c3), ...; with fewer than three corners it
    gives none.

    Parameters
    ----------
    vertices : (V, 3).

    Raises
    ------
    LimitExceeded, InvalidMesh
    """
    limits.check_vertices(len(vertices))
    if (polygons.sizes == 3).all():
        limits.check_faces(len(polygons.sizes))
        return Mesh(vertices, polygons.corners.reshape(-1, 3), appearance=appearance)
    triangles = np.maximum(polygons.sizes - 2, 0)
    limits.check_faces(int(triangles.sum()))
    source_polygon = np.repeat(np.arange(len(triangles), dtype=np.int32), triangles)
    return Mesh(vertices, polygons.corners[fan_corners(polygons.sizes)], source_polygon, appearance)


def ragged_range(start: LongArray, length: LongArray) -> LongArray:
    """start[0], start[0] + 1, ... (length[0] of them), start[1], start[1] + 1, ... and so on."""
    before = np.cumsum(length) - length
    return np.repeat(start - before, length) + np.arange(int(length.sum()))


def fan_corners(sizes: LongArray) -> LongArray:
    """(F, 3): the entries of ``Polygons.corners`` that the corners of every face are."""
    triangles = np.maximum(sizes - 2, 0)
    begin = np.cumsum(sizes) - sizes
    first, second = np.repeat(begin, triangles), ragged_range(begin + 1, triangles)
    return np.stack([first, second, second + 1], axis=1)


def strip_faces(indices: LongArray | IntArray, starts: BoolArray) -> LongArray | IntArray:
    """(T, 3): the triangles of strips, every second one turned so that all face the same way, degenerate ones kept.

    Parameters
    ----------
    indices : (N,) the vertices of all strips, one after the other.
    starts : (N,) True where a strip begins.
    """
    first = np.maximum.accumulate(np.where(starts, np.arange(len(indices)), 0))
    at = np.flatnonzero(first[:-2] == first[2:])
    odd = (at - first[at]) % 2
    return np.stack([indices[at], indices[at + 1 + odd], indices[at + 2 - odd]], axis=1)
