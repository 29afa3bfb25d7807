"""Triangulation of the polygons and strips of a file."""

from dataclasses import dataclass

import numpy as np

from segcore.appearance import Appearance
from segcore.arrays import BoolArray, FloatArray, IntArray, LongArray
from segcore.io.limits import ReadLimits
from segcore.io.polygon_kernels import clip_concave_polygons
from segcore.mesh import Mesh
from segcore.structure import FileStructure

_STEPS = 10**8  # of clipping in a file: a few seconds


@dataclass(frozen=True, slots=True, eq=False)
class Polygons:
    """The polygons of a file, in its order."""

    corners: LongArray | IntArray  # (sum of sizes,) the vertices of all polygons, concatenated
    sizes: LongArray  # (P,) the number of corners of each polygon, >= 0


def mesh_of_polygons(
    vertices: FloatArray,
    polygons: Polygons,
    limits: ReadLimits,
    appearance: Appearance | None = None,
    structure: FileStructure | None = None,
    notes: tuple[str, ...] = (),
) -> Mesh:
    """Return the mesh whose faces are the triangles of polygons, in their order; see :func:`triangle_corners`.

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
        return Mesh(vertices, polygons.corners.reshape(-1, 3), None, appearance, structure, notes)
    triangles = np.maximum(polygons.sizes - 2, 0)
    limits.check_faces(int(triangles.sum()))
    source_polygon = np.repeat(np.arange(len(triangles), dtype=np.int32), triangles)
    corners, fans = triangle_corners(vertices, polygons)
    too_small = int(np.count_nonzero(polygons.sizes < 3))
    if too_small:
        of_file = "1 face" if too_small == 1 else f"{too_small} faces"
        notes += (f"{of_file} of the file with fewer than three corners {'is' if too_small == 1 else 'are'} left out.",)
    if fans:
        notes += (f"{fans} concave polygons have too many corners to be clipped: they are triangulated as fans.",)
    return Mesh(vertices, polygons.corners[corners], source_polygon, appearance, structure, notes)


def triangle_corners(vertices: FloatArray, polygons: Polygons, steps: int = _STEPS) -> tuple[LongArray, int]:
    """(F, 3) indices into ``Polygons.corners`` of the corners of each face, and the number of concave fans.

    A polygon with corners c0, c1, ... becomes the faces (c0, c1, c2), (c0, c2, c3), ...; a polygon with fewer than
    three corners becomes none. If some of these faces are opposite to the Newell normal of the polygon, it is concave,
    and becomes as many ears that are not, without new vertices. A polygon that has no area or intersects itself stays
    a fan, and so do concave ones after ``steps`` steps of clipping, whose number is returned.
    """
    faces = fan_corners(polygons.sizes)
    corners = np.ascontiguousarray(polygons.corners)
    if polygons.sizes.max(initial=0) <= 3:
        return faces, 0
    return faces, clip_concave_polygons(
        np.ascontiguousarray(vertices, dtype=np.float64), corners, polygons.sizes, faces, steps
    )


def ragged_range(start: LongArray, length: LongArray) -> LongArray:
    """(sum of length,) start[0], start[0] + 1, ... (length[0] numbers), then start[1], start[1] + 1, ... and so on."""
    before = np.cumsum(length) - length
    return np.repeat(start - before, length) + np.arange(int(length.sum()))


def fan_corners(sizes: LongArray) -> LongArray:
    """(F, 3) indices into ``Polygons.corners`` of the corners of each face of fans."""
    triangles = np.maximum(sizes - 2, 0)
    begin = np.cumsum(sizes) - sizes
    first, second = np.repeat(begin, triangles), ragged_range(begin + 1, triangles)
    return np.stack([first, second, second + 1], axis=1)


def strip_faces(indices: LongArray | IntArray, starts: BoolArray) -> LongArray | IntArray:
    """(T, 3) triangles of strips, degenerate ones too; every second one is reversed so that all have one orientation.

    Parameters
    ----------
    indices : (N,) the vertices of all strips, concatenated.
    starts : (N,) True for the first vertex of a strip.
    """
    first = np.maximum.accumulate(np.where(starts, np.arange(len(indices)), 0))
    at = np.flatnonzero(first[:-2] == first[2:])
    odd = (at - first[at]) % 2
    return np.stack([indices[at], indices[at + 1 + odd], indices[at + 2 - odd]], axis=1)
