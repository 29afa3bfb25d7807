"""The nearest face on a ray, by a bounding volume hierarchy over the faces of a mesh.

The tree is complete and split at medians: every node halves its faces by their centres along the axis of their largest
spread, so that it needs no pointers (on such trees: Wald, Boulos and Shirley, Ray tracing deformable scenes using
dynamic bounding volume hierarchies, ACM Transactions on Graphics 26, 2007). A ray goes down three levels at a time and
meets the eight boxes there together (Wald, Benthin and Boulos, Getting rid of packets, IEEE Symposium on Interactive
Ray Tracing 2008). The intersection test is that of Moeller and Trumbore, Fast, minimum storage ray/triangle
intersection, 1997.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from segcore.affinity.eight_boxes import WIDTH, enter_boxes
from segcore.array_kernels import face_centroids
from segcore.arrays import FloatArray, IntArray, LongArray
from segcore.jit.decorators import inner_kernel, kernel
from segcore.threads import in_blocks

_LEAF = 4  # faces in a leaf, at most; set by hand
_DEPTH = 256  # of the stack of nodes: seven for each of 32 levels at most
# Nodes that the rays may visit together: for each ray, and beyond that. On meshes of the benchmark a ray visits 13 to
# 18 on average.
_VISITS, VISITS_AT_FIRST = 128, 2**20
_HUGE = 1e30  # inverse of a zero component of a direction


class RayCaster(NamedTuple):
    """Faces arranged for ray casting.

    Node i of the tree has the children 2 i and 2 i + 1, and three levels below it the nodes of group i, 8 i..8 i + 7.
    """

    first: LongArray  # (L + 1,) the faces of leaf k, node L + k of the tree, are first[k]..first[k + 1] - 1
    groups: NDArray[np.float32]  # (G, 6, 8) bounding boxes of the nodes of each group: least, then largest coordinates
    face: IntArray  # (F,) the faces in the order of the leaves
    corner: NDArray[np.float32]  # (F, 3) their first corners
    sides: NDArray[np.float32]  # (F, 6) the vectors from there to the two other corners

    @classmethod
    def of(cls, vertices: FloatArray, faces: IntArray) -> "RayCaster":
        """Arrange faces (F, 3) over vertices (V, 3), F >= 1. O(F log F)."""
        leaves = 1 << max(0, int(np.ceil(np.log2(len(faces) / _LEAF))))
        order = _arranged(face_centroids(vertices, faces).astype(np.float32), leaves)
        shapes = (2 * leaves, 6), (len(faces), 3), (len(faces), 6)
        boxes, corner, sides = (np.empty(shape, np.float32) for shape in shapes)
        in_blocks(_pack, leaves, vertices, faces, order, boxes, corner, sides)
        _enclose(boxes)
        first = len(faces) * np.arange(leaves + 1) // leaves
        return cls(first, _in_groups(boxes), order.astype(np.int32), corner, sides)

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
        distances = np.empty(len(origins))
        cast(self, origins, directions, distances, np.empty(len(origins), dtype=np.int32))
        return distances


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

    node: IntArray  # (256,)
    entry: NDArray[np.float32]  # (256,)
    entries: NDArray[np.float32]  # (8,) of the nodes of a group


@kernel
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


@inner_kernel
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


@inner_kernel
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


@kernel
def _pack(start, end, vertices, faces, order, boxes, corner, sides):  # type: ignore[no-untyped-def]
    """Write the corners and sides of the faces of some leaves, and the boxes of these leaves."""
    count = len(order)
    leaves = len(boxes) // 2
    for leaf in range(start, end):
        box = boxes[leaves + leaf]
        box[:3] = np.inf
        box[3:] = -np.inf
        for i in range(count * leaf // leaves, count * (leaf + 1) // leaves):
            for axis in range(3):
                a = np.float32(vertices[faces[order[i], 0], axis])
                b = np.float32(vertices[faces[order[i], 1], axis])
                c = np.float32(vertices[faces[order[i], 2], axis])
                corner[i, axis], sides[i, axis], sides[i, 3 + axis] = a, b - a, c - a
                box[axis] = min(box[axis], min(a, b, c))
                box[3 + axis] = max(box[3 + axis], max(a, b, c))


@kernel
def _enclose(boxes):  # type: ignore[no-untyped-def]
    """Write the boxes of the inner nodes, from those of the leaves up."""
    boxes[0] = 0.0
    for node in range(len(boxes) // 2 - 1, 0, -1):
        for axis in range(3):
            boxes[node, axis] = min(boxes[2 * node, axis], boxes[2 * node + 1, axis])
            boxes[node, 3 + axis] = max(boxes[2 * node, 3 + axis], boxes[2 * node + 1, 3 + axis])


def _in_groups(boxes: NDArray[np.float32]) -> NDArray[np.float32]:
    """(G, 6, 8) the boxes (2 L, 6) of nodes by groups; what is missing in the last group is met by no ray."""
    groups = np.empty((-(-len(boxes) // WIDTH) * WIDTH, 6), dtype=np.float32)
    groups[: len(boxes)] = boxes
    groups[len(boxes) :, :3], groups[len(boxes) :, 3:] = np.inf, -np.inf
    return np.ascontiguousarray(groups.reshape(-1, WIDTH, 6).transpose(0, 2, 1))


@kernel
def cast(
    caster: RayCaster,
    origins: FloatArray,
    directions: FloatArray,
    distances: FloatArray,
    faces: IntArray,
    left: int = VISITS_AT_FIRST,
) -> int:
    """Write ``RayCaster.inner_distances`` of N rays into ``distances`` (N,), for use in other kernels.

    Parameters
    ----------
    faces : (N,) receives the faces at these distances; -1 if there is none.
    left : what earlier rays have left of the nodes that may be visited.

    Returns
    -------
    What these rays have left of them.
    """
    leaves = len(caster.first) - 1
    stack = _Stack(
        np.empty(_DEPTH, dtype=np.int32), np.empty(_DEPTH, dtype=np.float32), np.empty(WIDTH, dtype=np.float32)
    )
    for i in range(len(origins)):
        ray = _ray(origins, directions, i)
        numbers = (ray.ox, ray.oy, ray.oz, ray.ix, ray.iy, ray.iz)
        nearest = np.float32(np.inf)
        place = 0
        from_inside = False
        size = _first_nodes(leaves, stack)
        left += _VISITS
        while size > 0:
            if left == 0:
                from_inside = False
                break
            left -= 1
            size -= 1
            if stack.entry[size] > nearest:
                continue
            node = np.int64(stack.node[size])
            if node < leaves:
                met = enter_boxes(caster.groups, node, numbers, nearest, stack.entries)
                size = _stacked(node, met, stack, size)
                continue
            for f in range(caster.first[node - leaves], caster.first[node - leaves + 1]):
                determinant, distance = _meets(caster.corner, caster.sides, f, ray)
                if distance < nearest:
                    nearest, place = distance, f
                    from_inside = determinant < 0.0
        distances[i] = np.float64(nearest) if from_inside else np.inf
        faces[i] = caster.face[place] if from_inside else -1
    return left


@inner_kernel
def _ray(origins, directions, i):  # type: ignore[no-untyped-def]
    ox, oy, oz = np.float32(origins[i, 0]), np.float32(origins[i, 1]), np.float32(origins[i, 2])
    dx, dy, dz = np.float32(directions[i, 0]), np.float32(directions[i, 1]), np.float32(directions[i, 2])
    return _Ray(ox, oy, oz, dx, dy, dz, _inverse(dx), _inverse(dy), _inverse(dz))


@inner_kernel
def _first_nodes(leaves, stack):  # type: ignore[no-untyped-def]
    """Put the nodes of the level on the stack from which groups of three levels lead to the leaves."""
    first = leaves
    while first >= WIDTH:
        first //= WIDTH
    for k in range(first):
        stack.node[k] = first + k
        stack.entry[k] = 0.0
    return first


@inner_kernel
def _stacked(node, met, stack, size):  # type: ignore[no-untyped-def]
    """Put the nodes of a group whose boxes were met on the stack, the farthest first."""
    bottom = size
    k = 0
    while met != 0:
        if met & 1:
            entry = stack.entries[k]
            place = size
            while place > bottom and stack.entry[place - 1] < entry:
                stack.entry[place], stack.node[place] = stack.entry[place - 1], stack.node[place - 1]
                place -= 1
            stack.entry[place], stack.node[place] = entry, WIDTH * node + k
            size += 1
        met >>= 1
        k += 1
    return size


@inner_kernel
def _inverse(x):  # type: ignore[no-untyped-def]
    return np.float32(1.0) / x if x != 0.0 else np.float32(_HUGE)


@inner_kernel
def _meets(corners, sides, f, ray):  # type: ignore[no-untyped-def]
    """The determinant, negative if the ray meets the face from behind, and the distance, infinity if it misses it."""
    dx, dy, dz = ray.dx, ray.dy, ray.dz
    ax, ay, az = sides[f, 0], sides[f, 1], sides[f, 2]
    bx, by, bz = sides[f, 3], sides[f, 4], sides[f, 5]
    px, py, pz = dy * bz - dz * by, dz * bx - dx * bz, dx * by - dy * bx
    determinant = ax * px + ay * py + az * pz
    missed = np.float32(np.inf)
    if determinant == 0.0:
        return determinant, missed
    scale = np.float32(1.0) / determinant
    tx, ty, tz = ray.ox - corners[f, 0], ray.oy - corners[f, 1], ray.oz - corners[f, 2]
    u = (tx * px + ty * py + tz * pz) * scale
    if u < 0.0 or u > 1.0:
        return determinant, missed
    qx, qy, qz = ty * az - tz * ay, tz * ax - tx * az, tx * ay - ty * ax
    v = (dx * qx + dy * qy + dz * qz) * scale
    if v < 0.0 or u + v > 1.0:
        return determinant, missed
    distance = (bx * qx + by * qy + bz * qz) * scale
    return determinant, distance if distance > 0.0 else missed
