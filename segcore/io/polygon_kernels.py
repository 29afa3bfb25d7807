"""Compiled kernels that triangulate concave polygons by clipping ears."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from segcore.arrays import FloatArray, LongArray
from segcore.jit.decorators import inner_kernel, kernel

_EPSILON = 2.0**-52
_OPPOSITE = 1e-6  # of the area of the polygon: what a fan may have of triangles opposite to it, by rounding
_NO_AREA = 1e-12  # of the square of the extent: less has no certain normal
_FLAT = 1e-15  # of the square of the extent: a corner with less is straight


class Ring(NamedTuple):
    """A polygon in its plane: corners in units of its extent, linked in a circle, counterclockwise."""

    x: FloatArray  # (N,)
    y: FloatArray  # (N,)
    before: LongArray  # (N,)
    after: LongArray  # (N,)
    flat: float  # twice the area up to which a triangle counts as flat


@kernel
def clip_concave_polygons(
    vertices: FloatArray, corners: NDArray[np.signedinteger[Any]], sizes: LongArray, faces: LongArray, steps: int
) -> int:
    """Replace the fans of concave polygons in ``faces`` (F, 3), indices into ``corners``, by clipped ears.

    A fan stays if its triangles have the side of the Newell normal of the polygon, or if no triangulation is found in
    which all have: the polygon has no area or intersects itself.

    Returns
    -------
    The number of concave polygons that stay fans because more than ``steps`` steps were needed.
    """
    begin, face, left_out = 0, 0, 0
    for size in sizes:
        if size > 3 and not _has_right_fan(vertices, corners, begin, size):
            ring = _concave_ring(vertices, corners[begin : begin + size])
            if len(ring.x):
                if steps > 0:
                    steps = _clip(ring, begin, faces[face : face + size - 2], steps)
                left_out += steps <= 0
        face += max(size - 2, 0)
        begin += size
    return left_out


@inner_kernel
def _has_right_fan(vertices: FloatArray, corners: NDArray[np.signedinteger[Any]], begin: int, size: int) -> bool:
    """Whether all triangles of the fan clearly have the side of the normal of the polygon: most polygons are convex."""
    for corner in range(begin, begin + size):
        if corners[corner] < 0 or corners[corner] >= len(vertices):
            return False
    n0, n1, n2 = 0.0, 0.0, 0.0
    for i in range(1, size - 1):
        t0, t1, t2 = _fan_cross(vertices, corners, begin, i)
        n0, n1, n2 = n0 + t0, n1 + t1, n2 + t2
    for i in range(1, size - 1):
        t0, t1, t2 = _fan_cross(vertices, corners, begin, i)
        if not t0 * n0 + t1 * n1 + t2 * n2 > 0.0:
            return False
    return True


@inner_kernel
def _fan_cross(
    vertices: FloatArray, corners: NDArray[np.signedinteger[Any]], begin: int, i: int
) -> tuple[float, float, float]:
    """Twice the area vector of triangle i of the fan of the polygon that begins at ``begin``."""
    o, p, q = corners[begin], corners[begin + i], corners[begin + i + 1]
    p0, p1, p2 = vertices[p, 0] - vertices[o, 0], vertices[p, 1] - vertices[o, 1], vertices[p, 2] - vertices[o, 2]
    q0, q1, q2 = vertices[q, 0] - vertices[o, 0], vertices[q, 1] - vertices[o, 1], vertices[q, 2] - vertices[o, 2]
    return p1 * q2 - p2 * q1, p2 * q0 - p0 * q2, p0 * q1 - p1 * q0


@inner_kernel
def _concave_ring(vertices: FloatArray, corners: NDArray[np.signedinteger[Any]]) -> Ring:
    """The polygon in its plane; without corners if its fan is right, or if it has no area."""
    size = len(corners)
    empty, none = np.empty(0), np.empty(0, np.int64)
    for corner in corners:
        if corner < 0 or corner >= len(vertices):  # Mesh refuses it
            return Ring(empty, empty, none, none, 0.0)
    origin = vertices[corners[0]]
    extent, largest = 0.0, 0.0
    for corner in corners:
        for axis in range(3):
            extent = max(extent, abs(vertices[corner, axis] - origin[axis]))
            largest = max(largest, abs(vertices[corner, axis]))
    if not (extent > 0.0 and extent < np.inf):
        return Ring(empty, empty, none, none, 0.0)
    noise = _EPSILON * largest / extent
    n0, n1, n2 = 0.0, 0.0, 0.0
    for i in range(1, size - 1):
        t0, t1, t2 = _cross(vertices, corners, i, extent)
        n0, n1, n2 = n0 + t0, n1 + t1, n2 + t2
    area = np.sqrt(n0 * n0 + n1 * n1 + n2 * n2)
    if not area > _NO_AREA + 64.0 * noise:
        return Ring(empty, empty, none, none, 0.0)
    n0, n1, n2 = n0 / area, n1 / area, n2 / area
    opposite = 0.0
    for i in range(1, size - 1):
        t0, t1, t2 = _cross(vertices, corners, i, extent)
        opposite -= min(t0 * n0 + t1 * n1 + t2 * n2, 0.0)
    if not opposite > _OPPOSITE * area:
        return Ring(empty, empty, none, none, 0.0)
    sign = 1.0 if n2 >= 0.0 else -1.0  # two axes of the plane, after Duff et al., Building an orthonormal basis, 2017
    a = -1.0 / (sign + n2)
    b = n0 * n1 * a
    x, y = np.empty(size), np.empty(size)
    before, after = np.arange(-1, size - 1), np.arange(1, size + 1)
    before[0], after[size - 1] = size - 1, 0
    for i in range(size):
        p0 = (vertices[corners[i], 0] - origin[0]) / extent
        p1 = (vertices[corners[i], 1] - origin[1]) / extent
        p2 = (vertices[corners[i], 2] - origin[2]) / extent
        x[i] = (1.0 + sign * n0 * n0 * a) * p0 + sign * b * p1 - sign * n0 * p2
        y[i] = b * p0 + (sign + n1 * n1 * a) * p1 - n1 * p2
    return Ring(x, y, before, after, _FLAT + 4.0 * noise)


@inner_kernel
def _cross(
    vertices: FloatArray, corners: NDArray[np.signedinteger[Any]], i: int, extent: float
) -> tuple[float, float, float]:
    """Twice the area vector of triangle i of the fan, in units of ``extent``."""
    o, p, q = vertices[corners[0]], vertices[corners[i]], vertices[corners[i + 1]]
    p0, p1, p2 = (p[0] - o[0]) / extent, (p[1] - o[1]) / extent, (p[2] - o[2]) / extent
    q0, q1, q2 = (q[0] - o[0]) / extent, (q[1] - o[1]) / extent, (q[2] - o[2]) / extent
    return p1 * q2 - p2 * q1, p2 * q0 - p0 * q2, p0 * q1 - p1 * q0


@inner_kernel
def _clip(ring: Ring, begin: int, faces: LongArray, steps: int) -> int:
    """Fill ``faces`` (N - 2, 3) with ears of the ring, counted from ``begin``; return the steps that are left.

    The faces do not change if a part of the ring has no ear. All ears have the side of the ring, so that those of a
    ring which does not intersect itself cover it once.
    """
    size = len(ring.x)
    is_blocking = np.empty(size, np.bool_)
    for i in range(size):
        is_blocking[i] = _double_area(ring, ring.before[i], i, ring.after[i]) <= ring.flat
    order = np.flatnonzero(is_blocking)
    order = order[np.argsort(ring.x[order], kind="mergesort")]
    places = ring.x[order]
    ears = np.empty_like(faces)
    at, count, failures = 0, 0, 0
    while count < len(faces):
        left, right = ring.before[at], ring.after[at]
        area = _double_area(ring, left, at, right)
        steps -= 1
        is_ear = area > ring.flat
        if is_ear:
            is_ear, steps = _is_free(ring, at, order, places, is_blocking, steps)
        elif failures > size - count:  # no ear is left: a straight corner may go
            is_ear = area >= -ring.flat
        if steps <= 0:
            return 0
        if not is_ear:
            failures += 1
            if failures > 2 * (size - count) + 2:
                return steps
            at = right
            continue
        ears[count] = left, at, right
        count += 1
        failures = 0
        ring.after[left], ring.before[right] = right, left
        is_blocking[at] = False
        for i in (left, right):
            if is_blocking[i]:
                is_blocking[i] = _double_area(ring, ring.before[i], i, ring.after[i]) <= ring.flat
        at = ring.after[right]
    faces[:] = ears + begin
    return steps


@inner_kernel
def _is_free(
    ring: Ring, at: int, order: LongArray, places: FloatArray, is_blocking: NDArray[np.bool_], steps: int
) -> tuple[bool, int]:
    """Whether no blocking corner is in the closed triangle at a corner, and the steps that are left.

    Parameters
    ----------
    order, places : the corners that were blocking at first, by their x, and their x.
    """
    left, right = ring.before[at], ring.after[at]
    lowest = min(ring.x[left], ring.x[at], ring.x[right])
    highest = max(ring.x[left], ring.x[at], ring.x[right])
    for k in range(np.searchsorted(places, lowest), len(places)):
        steps -= 1
        if places[k] > highest:
            break
        i = order[k]
        if not is_blocking[i] or i in (left, at, right) or _coincides(ring, i, left, at, right):
            continue
        if (
            _double_area(ring, left, at, i) >= -ring.flat
            and _double_area(ring, at, right, i) >= -ring.flat
            and _double_area(ring, right, left, i) >= -ring.flat
        ):
            return False, steps
    return True, steps


@inner_kernel
def _coincides(ring: Ring, i: int, a: int, b: int, c: int) -> bool:
    """Whether corner i has the position of another one, as at the bridge from a border to a hole."""
    x, y = ring.x[i], ring.y[i]
    return (
        (x == ring.x[a] and y == ring.y[a])
        or (x == ring.x[b] and y == ring.y[b])
        or (x == ring.x[c] and y == ring.y[c])
    )


@inner_kernel
def _double_area(ring: Ring, a: int, b: int, c: int) -> float:
    """Twice the signed area of a triangle."""
    return (ring.x[b] - ring.x[a]) * (ring.y[c] - ring.y[a]) - (ring.y[b] - ring.y[a]) * (ring.x[c] - ring.x[a])
