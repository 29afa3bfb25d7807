"""The nearest face on a ray, by a bounding volume hierarchy over the faces of a mesh.

The tree is complete and split at medians: every node halves its faces by their centres along the axis of their largest
spread, so that it needs no pointers (on such trees: Wald, Boulos and Shirley, Ray tracing deformable scenes using
dynamic bounding volume hierarchies, ACM Transactions on Graphics 26, 2007). The intersection test is that of Moeller
and Trumbore, Fast, minimum storage ray/triangle intersection, 1997.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from segcore.arrays import FloatArray, IntArray
from segcore.mesh import face_centroids
from segcore.threads import in_blocks

_LEAF = 4  # faces in a leaf, at most; set by hand
_DEPTH = 64  # of the stack of nodes; more than the tree can have levels
# Nodes that the rays may visit together: for each ray, and beyond that. On the meshes of the benchmark and the assets a
# ray visits 30 to 53 on average, and never more than 300.
_VISITS, _VISITS_AT_FIRST = 128, 2**20
_HUGE = 1e30  # inverse of a zero component of a direction


class RayCaster(NamedTuple):
    """Faces arranged for ray casting. Node i of the tree has the children 2 i and 2 i + 1; the leaves start at L."""

    boxes: NDArray[np.float32]  # (2 L, 6) bounding boxes of the nodes: least, then largest coordinates
    corner: NDArray[np.float32]  # (F, 3) first corner of the faces in the order of the leaves
    sides: NDArray[np.float32]  # (F, 6) the vectors from there to the two other corners

    @classmethod
    def of(cls, vertices: FloatArray, faces: IntArray) -> "RayCaster":
        """Arrange faces (F, 3) over vertices (V, 3), F >= 1. O(F log F)."""
        leaves = 1 << max(0, int(np.ceil(np.log2(len(faces) / _LEAF))))
        order = _arranged(face_centroids(vertices, faces).astype(np.float32), leaves)
        caster = cls(*(np.empty(shape, np.float32) for shape in ((2 * leaves, 6), (len(faces), 3), (len(faces), 6))))
        in_blocks(_pack, leaves, vertices, faces, order, caster)
        _enclose(caster.boxes)
        return caster

    def inner_distances(self, origins: FloatArray, directions: FloatArray) -> FloatArray:
        """Distances at which rays leave a body.

        Parameters
        ----------
        origins, directions : (N, 3), directions of unit length.

        Returns
        -------
        (N,) the distance to the nearest face; infinity if there is none, or if the ray meets its front, in which case
        the ray was not inside a body. Also infinity if the search was given up: among faces that cross each other
        everywhere, as long as the whole, a ray would otherwise visit most of them. The time is O(N) for any mesh.
        """
        return _inner_distances(self, origins, directions)


class _Ray(NamedTuple):
    """Origin, direction and reciprocal direction of a ray."""

    ox: np.float32
    oy: np.float32
    oz: np.float32
    dx: np.float32
    dy: np.float32
    dz: np.float32
    ix: np.float32
    iy: np.float32
    iz: np.float32


class _Stack(NamedTuple):
    """Nodes that are still to be visited, and the distances at which the ray enters their boxes."""

    node: IntArray  # (64,)
    entry: NDArray[np.float32]  # (64,)


@njit(cache=True, nogil=True)
def _arranged(centres, leaves):  # type: ignore[no-untyped-def]
    """(F,) the faces in the order of the leaves. The centres (F, 3) are reordered in place."""
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


@njit(cache=True, nogil=True)
def _widest_axis(centres, low, high):  # type: ignore[no-untyped-def]
    """The axis of the largest spread of the centres low..high - 1."""
    best, widest = 0, np.float32(-1.0)
    for axis in range(3):
        least, most = np.float32(np.inf), np.float32(-np.inf)
        for i in range(low, high):
            least, most = min(least, centres[i, axis]), max(most, centres[i, axis])
        if most - least > widest:
            best, widest = axis, most - least
    return best


@njit(cache=True, nogil=True)
def _halve(centres, order, low, high, middle, axis):  # type: ignore[no-untyped-def]
    """Quickselect: reorder so that centres before ``middle`` are not larger along the axis than those after it."""
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


@njit(cache=True, nogil=True)
def _pack(start, end, vertices, faces, order, caster):  # type: ignore[no-untyped-def]
    """Write the corners and sides of the faces of some leaves, and the boxes of these leaves."""
    count = len(order)
    leaves = len(caster.boxes) // 2
    for leaf in range(start, end):
        box = caster.boxes[leaves + leaf]
        box[:3] = np.inf
        box[3:] = -np.inf
        for i in range(count * leaf // leaves, count * (leaf + 1) // leaves):
            for axis in range(3):
                a = np.float32(vertices[faces[order[i], 0], axis])
                b = np.float32(vertices[faces[order[i], 1], axis])
                c = np.float32(vertices[faces[order[i], 2], axis])
                caster.corner[i, axis], caster.sides[i, axis], caster.sides[i, 3 + axis] = a, b - a, c - a
                box[axis] = min(box[axis], min(a, b, c))
                box[3 + axis] = max(box[3 + axis], max(a, b, c))


@njit(cache=True, nogil=True)
def _enclose(boxes):  # type: ignore[no-untyped-def]
    """Write the boxes of the inner nodes, from those of the leaves up."""
    boxes[0] = 0.0
    for node in range(len(boxes) // 2 - 1, 0, -1):
        for axis in range(3):
            boxes[node, axis] = min(boxes[2 * node, axis], boxes[2 * node + 1, axis])
            boxes[node, 3 + axis] = max(boxes[2 * node, 3 + axis], boxes[2 * node + 1, 3 + axis])


@njit(cache=True)
def _inner_distances(caster: RayCaster, origins: FloatArray, directions: FloatArray) -> FloatArray:
    distances = np.empty(len(origins))
    stack = _Stack(np.empty(_DEPTH, dtype=np.int32), np.empty(_DEPTH, dtype=np.float32))
    left = _VISITS_AT_FIRST
    for i in range(len(origins)):
        left += _VISITS
        distances[i], visits = _inner_distance(caster, _ray(origins[i], directions[i]), stack, left)
        left -= visits
    return distances


@njit(cache=True)
def _ray(origin, direction):  # type: ignore[no-untyped-def]
    ox, oy, oz = np.float32(origin[0]), np.float32(origin[1]), np.float32(origin[2])
    dx, dy, dz = np.float32(direction[0]), np.float32(direction[1]), np.float32(direction[2])
    return _Ray(ox, oy, oz, dx, dy, dz, _inverse(dx), _inverse(dy), _inverse(dz))


@njit(cache=True)
def _inner_distance(caster, ray, stack, most_visits):  # type: ignore[no-untyped-def]
    """The distance, infinity after ``most_visits`` nodes; and the number of nodes that were visited."""
    leaves = len(caster.boxes) // 2
    count = len(caster.corner)
    nearest = np.float32(np.inf)
    from_inside = False
    size = 1
    stack.node[0] = 1
    stack.entry[0] = 0.0
    visits = 0
    while size > 0:
        if visits == most_visits:
            return np.inf, visits
        visits += 1
        size -= 1
        if stack.entry[size] > nearest:
            continue
        node = stack.node[size]
        if node >= leaves:
            leaf = node - leaves
            for f in range(count * leaf // leaves, count * (leaf + 1) // leaves):
                determinant, distance = _meets(caster.corner[f], caster.sides[f], ray)
                if distance < nearest:
                    nearest = distance
                    from_inside = determinant < 0.0
            continue
        near = _enters(caster.boxes[2 * node], ray, nearest)
        far = _enters(caster.boxes[2 * node + 1], ray, nearest)
        first, second = 2 * node, 2 * node + 1
        if far < near:
            first, second, near, far = second, first, far, near
        if far < np.inf:
            stack.node[size] = second
            stack.entry[size] = far
            size += 1
        if near < np.inf:
            stack.node[size] = first
            stack.entry[size] = near
            size += 1
    return (np.float64(nearest) if from_inside else np.inf), visits


@njit(cache=True)
def _inverse(x):  # type: ignore[no-untyped-def]
    return np.float32(1.0) / x if x != 0.0 else np.float32(_HUGE)


@njit(cache=True)
def _enters(box, ray, nearest):  # type: ignore[no-untyped-def]
    """The distance at which a ray enters a box; infinity if it misses the box or enters beyond ``nearest``."""
    a, b = (box[0] - ray.ox) * ray.ix, (box[3] - ray.ox) * ray.ix
    low, high = min(a, b), max(a, b)
    a, b = (box[1] - ray.oy) * ray.iy, (box[4] - ray.oy) * ray.iy
    low, high = max(low, min(a, b)), min(high, max(a, b))
    a, b = (box[2] - ray.oz) * ray.iz, (box[5] - ray.oz) * ray.iz
    low, high = max(low, min(a, b), np.float32(0.0)), min(high, max(a, b), nearest)
    return low if low <= high else np.float32(np.inf)


@njit(cache=True)
def _meets(corner, sides, ray):  # type: ignore[no-untyped-def]
    """The determinant, negative if the ray meets the face from behind, and the distance, infinity if it misses it."""
    dx, dy, dz = ray.dx, ray.dy, ray.dz
    ax, ay, az, bx, by, bz = sides[0], sides[1], sides[2], sides[3], sides[4], sides[5]
    px, py, pz = dy * bz - dz * by, dz * bx - dx * bz, dx * by - dy * bx
    determinant = ax * px + ay * py + az * pz
    missed = np.float32(np.inf)
    if determinant == 0.0:
        return determinant, missed
    scale = np.float32(1.0) / determinant
    tx, ty, tz = ray.ox - corner[0], ray.oy - corner[1], ray.oz - corner[2]
    u = (tx * px + ty * py + tz * pz) * scale
    if u < 0.0 or u > 1.0:
        return determinant, missed
    qx, qy, qz = ty * az - tz * ay, tz * ax - tx * az, tx * ay - ty * ax
    v = (dx * qx + dy * qy + dz * qz) * scale
    if v < 0.0 or u + v > 1.0:
        return determinant, missed
    distance = (bx * qx + by * qy + bz * qz) * scale
    return determinant, distance if distance > 0.0 else missed
