"""The nearest face that a ray meets: a bounding volume hierarchy over the faces of a mesh.

The tree is complete and split at medians: every node halves its faces by their centres along the axis in which these
spread most, so that it needs no pointers (on such trees: Wald, Boulos and Shirley, Ray tracing deformable scenes using
dynamic bounding volume hierarchies, ACM Transactions on Graphics 26, 2007). Intersections are those of Moeller
and Trumbore, Fast, minimum storage ray/triangle intersection, 1997.
"""

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from segcore.arrays import FloatArray, IntArray
from segcore.mesh import face_centroids

_LEAF = 4  # faces in a leaf, at most


@dataclass(frozen=True, slots=True, eq=False)
class RayCaster:
    """Faces arranged for ray casting."""

    boxes: NDArray[np.float32]  # (2 L, 6) bounding boxes; node i has children 2 i, 2 i + 1; leaves from L
    corner: NDArray[np.float32]  # (F, 3) first corner of the faces in the order of the leaves
    sides: NDArray[np.float32]  # (F, 6) the sides from there to the two others

    @classmethod
    def of(cls, vertices: FloatArray, faces: IntArray) -> "RayCaster":
        """Arrange faces (F, 3) over vertices (V, 3), F >= 1. O(F log F)."""
        leaves = 1 << max(0, int(np.ceil(np.log2(len(faces) / _LEAF))))
        order = _arranged(face_centroids(vertices, faces).astype(np.float32), leaves)
        corners = vertices.astype(np.float32)[faces[order]]
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


@njit(cache=True)
def _arranged(centres, leaves):  # type: ignore[no-untyped-def]
    """The faces in the order of the leaves; the centres are put into that order too."""
    count = len(centres)
    order = np.arange(count)
    nodes = [(0, leaves)]
    while nodes:
        first, end = nodes.pop()
        if end - first == 1:
            continue
        middle = (first + end) // 2
        low, high = count * first // leaves, count * end // leaves
        _halve(centres, order, low, high, count * middle // leaves, _widest_axis(centres, low, high))
        nodes.append((first, middle))
        nodes.append((middle, end))
    return order


@njit(cache=True)
def _widest_axis(centres, low, high):  # type: ignore[no-untyped-def]
    best, widest = 0, np.float32(-1.0)
    for axis in range(3):
        least, most = np.float32(np.inf), np.float32(-np.inf)
        for i in range(low, high):
            least, most = min(least, centres[i, axis]), max(most, centres[i, axis])
        if most - least > widest:
            best, widest = axis, most - least
    return best


@njit(cache=True)
def _halve(centres, order, low, high, middle, axis):  # type: ignore[no-untyped-def]
    """Quickselect: what lies before ``middle`` is afterwards nowhere larger along the axis than what lies behind it."""
    last = high - 1
    while low < last:
        pivot = centres[(low + last) // 2, axis]
        i, j = low, last
        while i <= j:
            while centres[i, axis] < pivot:
                i += 1
            while centres[j, axis] > pivot:
                j -= 1
            if i <= j:
                for k in range(3):
                    centres[i, k], centres[j, k] = centres[j, k], centres[i, k]
                order[i], order[j] = order[j], order[i]
                i += 1
                j -= 1
        if middle <= j:
            last = j
        elif middle >= i:
            low = i
        else:
            return


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
