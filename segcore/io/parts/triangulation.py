"""Triangles that fill a closed loop of vertices in space."""

from dataclasses import dataclass

import numpy as np

from segcore.arrays import FloatArray, IntArray, LongArray, plane_axes, transformed
from segcore.jit.decorators import inner_kernel, kernel

# The number of ears, each with a shorter base than the one before, that end the search. Set by hand: one is enough for
# a valid cap, more avoid long thin triangles.
_IMPROVEMENTS = 8
_MOST_PAIRS = 10**7  # of corners of two loops between which a ribbon is sought: 90 MB
_ROUNDING = 1e-9  # of the area of a polygon


@dataclass(frozen=True, slots=True, eq=False)
class Filling:
    """The triangles that fill a loop."""

    triangles: LongArray  # (N - 2, 3) positions in the loop
    is_plain: bool  # the loop and its triangles have a projection without overlaps


def fill_flat(points: FloatArray, vertex: IntArray) -> Filling:
    """Triangulate a loop in the plane that fits it best, by ear clipping.

    Parameters
    ----------
    points : (N, 3) the corners of the loop, N >= 3.
    vertex : (N,) numbers of the corners; a loop of several that are joined has the ends of bridges twice.

    References
    ----------
    Meisters, Polygons have ears, 1975. Newell's normal: Sutherland, Sproull and Schumacker, A characterization of ten
    hidden-surface algorithms, 1974.
    """
    if len(points) == 3:
        return Filling(np.arange(3)[None], True)
    flat = _projected(points)
    triangles = cut_ears(flat)
    turns = _doubled_areas(flat, triangles)
    total = float(turns.sum())
    is_plain = total > 0 and bool((turns >= -_ROUNDING * total).all()) and not _touches_itself(triangles, vertex)
    return Filling(triangles, is_plain)


def fill_ribbon(points: FloatArray, first: int) -> Filling | None:
    """Fill two loops that are joined by a bridge with the ribbon of least area between them.

    Returns None if the loops are too long.

    Parameters
    ----------
    points : (N + M + 2, 3) the N corners of the first loop and its corner 0 again, and the same of the second loop.
    first : N.

    References
    ----------
    Fuchs, Kedem and Uselton, Optimal surface reconstruction from planar contours, 1977.
    """
    if (first + 1) * (len(points) - first - 1) > _MOST_PAIRS:
        return None
    triangles = ribbon(points[: first + 1], points[first + 1 :][::-1])
    is_second = triangles > first
    triangles = np.where(is_second, len(points) + first - triangles, triangles)
    return Filling(triangles, False)


def _touches_itself(triangles: LongArray, vertex: IntArray) -> bool:
    """Whether a triangle has one vertex twice."""
    a, b, c = vertex[triangles].T
    return bool(((a == b) | (b == c) | (c == a)).any())


def _doubled_areas(flat: FloatArray, triangles: LongArray) -> FloatArray:
    a, b, c = (flat[triangles[:, k]] for k in range(3))
    (ux, uy), (vx, vy) = (b - a).T, (c - a).T
    areas: FloatArray = ux * vy - uy * vx
    return areas


def _projected(points: FloatArray) -> FloatArray:
    """(N, 2) the points of a loop in the plane with Newell's normal, counter-clockwise."""
    relative = points - points.mean(axis=0)
    normal = np.cross(relative, np.roll(relative, -1, axis=0)).sum(axis=0)
    size = float(np.linalg.norm(normal))
    normal = normal / size if size > 0 else np.array([0.0, 0.0, 1.0])
    return transformed(relative, plane_axes(normal))


@kernel
def ribbon(one: FloatArray, other: FloatArray) -> LongArray:
    """(N + M - 2, 3) the triangles of least area between the ends of two chains (N, 3) and (M, 3). O(N M).

    Corner j of the second chain has the number N + j.
    """
    count, others = len(one), len(other)
    least = np.full((count, others), np.inf)
    along_one = np.zeros((count, others), np.bool_)  # the last triangle has an edge of the first chain
    least[0, 0] = 0.0
    for i in range(count):
        for j in range(others):
            if i > 0:
                least[i, j] = least[i - 1, j] + _triangle_area(one[i - 1], one[i], other[j])
                along_one[i, j] = True
            if j > 0:
                total = least[i, j - 1] + _triangle_area(one[i], other[j], other[j - 1])
                if total < least[i, j]:
                    least[i, j], along_one[i, j] = total, False
    triangles = np.empty((count + others - 2, 3), np.int64)
    i, j = count - 1, others - 1
    for done in range(len(triangles)):
        if along_one[i, j]:
            triangles[done, 0], triangles[done, 1], triangles[done, 2] = i - 1, i, count + j
            i -= 1
        else:
            triangles[done, 0], triangles[done, 1], triangles[done, 2] = i, count + j, count + j - 1
            j -= 1
    return triangles


@inner_kernel
def _triangle_area(a: FloatArray, b: FloatArray, c: FloatArray) -> float:
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    vx, vy, vz = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    x, y, z = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    return 0.5 * np.sqrt(x * x + y * y + z * z)


@kernel
def cut_ears(points: FloatArray) -> LongArray:
    """(N - 2, 3) triangles of a counter-clockwise polygon (N, 2), by ear clipping.

    An ear is a corner whose triangle contains no other corner. Each step cuts off the ear with the shortest base that
    is found in one round from the last ear on, which ends early after 8 improvements. A polygon that crosses itself may
    have no ear; then the corner with the shortest base is cut off.
    """
    count = len(points)
    after = np.roll(np.arange(count), -1)
    before = np.roll(np.arange(count), 1)
    triangles = np.empty((count - 2, 3), np.int64)
    at = 0
    for done in range(count - 2):
        best, best_base, fallback, fallback_base = -1, np.inf, at, np.inf
        corner = at
        tried = 0
        for _ in range(count - done):
            a, c = before[corner], after[corner]
            base = (points[a, 0] - points[c, 0]) ** 2 + (points[a, 1] - points[c, 1]) ** 2
            if base < fallback_base:
                fallback, fallback_base = corner, base
            if base < best_base and _is_ear(points, after, a, corner, c):
                best, best_base = corner, base
                tried += 1
                if tried == _IMPROVEMENTS:
                    break
            corner = c
        corner = best if best >= 0 else fallback
        a, c = before[corner], after[corner]
        triangles[done, 0], triangles[done, 1], triangles[done, 2] = a, corner, c
        after[a], before[c] = c, a
        at = a
    return triangles


@inner_kernel
def _is_ear(points: FloatArray, after: LongArray, a: int, b: int, c: int) -> bool:
    if _turn(points, a, b, c) <= 0:
        return False
    p = after[c]
    while p != a:
        if _turn(points, a, b, p) >= 0 and _turn(points, b, c, p) >= 0 and _turn(points, c, a, p) >= 0:
            is_corner = _same(points, p, a) or _same(points, p, b) or _same(points, p, c)
            if not is_corner:  # the ends of a bridge are corners twice
                return False
        p = after[p]
    return True


@inner_kernel
def _same(points: FloatArray, a: int, b: int) -> bool:
    return points[a, 0] == points[b, 0] and points[a, 1] == points[b, 1]


@inner_kernel
def _turn(points: FloatArray, a: int, b: int, c: int) -> float:
    """Twice the signed area of a triangle."""
    return (points[b, 0] - points[a, 0]) * (points[c, 1] - points[a, 1]) - (points[b, 1] - points[a, 1]) * (
        points[c, 0] - points[a, 0]
    )
