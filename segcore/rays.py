"""The nearest face that a ray meets: a bounding volume hierarchy over the faces of a mesh.

Faces are sorted along a Morton curve and grouped into leaves of a complete binary tree, so that building it is one sort
and one pass (Lauterbach et al., Fast BVH construction on GPUs, 2009). Intersections are those of Moeller and Trumbore,
Fast, minimum storage ray/triangle intersection, 1997.
"""

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from segcore.arrays import FloatArray, IntArray

_LEAF = 4  # faces in a leaf, at most
_MORTON_BITS = 16  # per axis
_TINY = 1e-300


@dataclass(frozen=True, slots=True, eq=False)
class RayCaster:
    """Faces arranged for ray casting."""

    boxes: NDArray[np.float32]  # (2 L, 6) bounding boxes; node i has children 2 i, 2 i + 1; leaves from L
    corner: NDArray[np.float32]  # (F, 3) first corner of the faces in the order of the leaves
    sides: NDArray[np.float32]  # (F, 6) the sides from there to the two others

    @classmethod
    def of(cls, vertices: FloatArray, faces: IntArray) -> "RayCaster":
        """Arrange faces (F, 3) over vertices (V, 3), F >= 1. O(F log F)."""
        corners = vertices.astype(np.float32)[faces[_along_curve(vertices, faces)]]
        leaves = 1 << max(0, int(np.ceil(np.log2(len(faces) / _LEAF))))
        sides = np.concatenate([corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]], axis=1)
        return cls(_boxes(corners, leaves), np.ascontiguousarray(corners[:, 0]), sides)

    def inner_distances(self, origins: FloatArray, directions: FloatArray) -> FloatArray:
        """How far rays go until they leave a body.

        Parameters
        ----------
        origins, directions : (N, 3), directions of unit length.

        Returns
        -------
        (N,) the distance to the nearest face, infinity where there is none or where it is met from its front, that is
        where the ray has not been inside a body.
        """
        return _inner_distances(self.boxes, self.corner, self.sides, origins, directions)


def _along_curve(vertices: FloatArray, faces: IntArray) -> NDArray[np.int64]:
    a, b, c = faces.T
    centroids = (vertices[a] + vertices[b] + vertices[c]) / 3.0
    low = centroids.min(axis=0)
    extent = float((centroids.max(axis=0) - low).max())
    cells = ((centroids - low) * ((2**_MORTON_BITS - 1) / extent if extent > _TINY else 0.0)).astype(np.uint64)
    return np.argsort(_morton_codes(cells), kind="stable")


@njit(cache=True)
def _morton_codes(cells):  # type: ignore[no-untyped-def]
    codes = np.zeros(len(cells), dtype=np.uint64)
    for i in range(len(cells)):
        for bit in range(16):
            for axis in range(3):
                codes[i] |= ((cells[i, axis] >> np.uint64(bit)) & np.uint64(1)) << np.uint64(3 * bit + axis)
    return codes


@njit(cache=True)
def _boxes(corners, leaves):  # type: ignore[no-untyped-def]
    count = len(corners)
    boxes = np.empty((2 * leaves, 6), dtype=np.float32)
    boxes[:, :3] = np.inf
    boxes[:, 3:] = -np.inf
    for leaf in range(leaves):
        node = leaves + leaf
        for f in range(count * leaf // leaves, count * (leaf + 1) // leaves):
            for k in range(3):
                for axis in range(3):
                    boxes[node, axis] = min(boxes[node, axis], corners[f, k, axis])
                    boxes[node, 3 + axis] = max(boxes[node, 3 + axis], corners[f, k, axis])
    for node in range(leaves - 1, 0, -1):
        for axis in range(3):
            boxes[node, axis] = min(boxes[2 * node, axis], boxes[2 * node + 1, axis])
            boxes[node, 3 + axis] = max(boxes[2 * node, 3 + axis], boxes[2 * node + 1, 3 + axis])
    return boxes


@njit(cache=True)
def _inner_distances(boxes, corner, sides, origins, directions):  # type: ignore[no-untyped-def]
    distances = np.empty(len(origins))
    stack = np.empty(64, dtype=np.int32)
    entry = np.empty(64, dtype=np.float32)
    for i in range(len(origins)):
        distances[i] = _inner_distance(boxes, corner, sides, origins[i], directions[i], stack, entry)
    return distances


@njit(cache=True)
def _inner_distance(boxes, corner, sides, origin, direction, stack, entry):  # type: ignore[no-untyped-def]
    ox, oy, oz = np.float32(origin[0]), np.float32(origin[1]), np.float32(origin[2])
    dx, dy, dz = np.float32(direction[0]), np.float32(direction[1]), np.float32(direction[2])
    ix, iy, iz = _inverse(dx), _inverse(dy), _inverse(dz)
    leaves = len(boxes) // 2
    count = len(corner)
    nearest = np.float32(np.inf)
    from_inside = False
    size = 1
    stack[0] = 1
    entry[0] = 0.0
    while size > 0:
        size -= 1
        if entry[size] > nearest:
            continue
        node = stack[size]
        if node >= leaves:
            leaf = node - leaves
            for f in range(count * leaf // leaves, count * (leaf + 1) // leaves):
                determinant, distance = _meets(corner[f], sides[f], ox, oy, oz, dx, dy, dz)
                if distance < nearest:
                    nearest = distance
                    from_inside = determinant < 0.0
            continue
        near = _enters(boxes[2 * node], ox, oy, oz, ix, iy, iz, nearest)
        far = _enters(boxes[2 * node + 1], ox, oy, oz, ix, iy, iz, nearest)
        first, second = 2 * node, 2 * node + 1
        if far < near:
            first, second, near, far = second, first, far, near
        if far < np.inf:
            stack[size] = second
            entry[size] = far
            size += 1
        if near < np.inf:
            stack[size] = first
            entry[size] = near
            size += 1
    return nearest if from_inside else np.inf


@njit(cache=True)
def _inverse(x):  # type: ignore[no-untyped-def]
    return np.float32(1.0) / x if x != 0.0 else np.float32(1e30)


@njit(cache=True)
def _enters(box, ox, oy, oz, ix, iy, iz, nearest):  # type: ignore[no-untyped-def]
    """The distance at which a ray enters a box, infinity where it misses it."""
    a, b = (box[0] - ox) * ix, (box[3] - ox) * ix
    low, high = min(a, b), max(a, b)
    a, b = (box[1] - oy) * iy, (box[4] - oy) * iy
    low, high = max(low, min(a, b)), min(high, max(a, b))
    a, b = (box[2] - oz) * iz, (box[5] - oz) * iz
    low, high = max(low, min(a, b), np.float32(0.0)), min(high, max(a, b), nearest)
    return low if low <= high else np.float32(np.inf)


@njit(cache=True)
def _meets(corner, sides, ox, oy, oz, dx, dy, dz):  # type: ignore[no-untyped-def]
    """The determinant (negative where the face is met from behind) and the distance, infinity where there is none."""
    ax, ay, az, bx, by, bz = sides[0], sides[1], sides[2], sides[3], sides[4], sides[5]
    px, py, pz = dy * bz - dz * by, dz * bx - dx * bz, dx * by - dy * bx
    determinant = ax * px + ay * py + az * pz
    missed = np.float32(np.inf)
    if determinant == 0.0:
        return determinant, missed
    scale = np.float32(1.0) / determinant
    tx, ty, tz = ox - corner[0], oy - corner[1], oz - corner[2]
    u = (tx * px + ty * py + tz * pz) * scale
    if u < 0.0 or u > 1.0:
        return determinant, missed
    qx, qy, qz = ty * az - tz * ay, tz * ax - tx * az, tx * ay - ty * ax
    v = (dx * qx + dy * qy + dz * qz) * scale
    if v < 0.0 or u + v > 1.0:
        return determinant, missed
    distance = (bx * qx + by * qy + bz * qz) * scale
    return determinant, distance if distance > 0.0 else missed
