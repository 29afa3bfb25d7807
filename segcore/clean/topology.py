"""Compiled kernels for the connectivity of the faces of a mesh: dual edges, borders, orientation."""

from typing import NamedTuple

import numpy as np

from segcore.array_kernels import ascending
from segcore.arrays import BoolArray, FloatArray, IntArray, LongArray
from segcore.graphs.surface_graph import Rows
from segcore.jit.decorators import inner_kernel, kernel

_EMPTY = -1
_FEW = 32  # edges of one lower end up to which they are sorted by insertion; set by hand


class DualEdges(NamedTuple):
    """Pairs of faces that share a mesh edge."""

    faces: IntArray  # (E, 2) the two faces
    vertices: IntArray  # (E, 2) the ends of the shared edge, the smaller first
    is_manifold: BoolArray  # (E,) exactly two faces share the edge
    disagrees: BoolArray  # (E,) both faces run through the edge in the same direction: their orientations differ


@inner_kernel
def mixed_bits(key: np.uint64) -> np.uint64:
    """The finaliser of SplitMix64: mixes the bits of a key over the whole word."""
    key = (key ^ (key >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    key = (key ^ (key >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return key ^ (key >> np.uint64(31))


@kernel
def first_equal_row(rows: LongArray | IntArray) -> IntArray:
    """(N,) for every row of (N, 3) the index of the first row equal to it, by a hash table with open addressing."""
    count = len(rows)
    capacity = 16
    while capacity < 2 * count:
        capacity *= 2
    mask = np.uint64(capacity - 1)
    slots = np.full(capacity, _EMPTY, np.int32)
    first = np.empty(count, np.int32)
    for i in range(count):
        a, b, c = rows[i, 0], rows[i, 1], rows[i, 2]
        slot = mixed_bits(mixed_bits(mixed_bits(np.uint64(a)) + np.uint64(b)) + np.uint64(c)) & mask
        while True:
            j = slots[slot]
            if j == _EMPTY:
                slots[slot] = i
                first[i] = i
                break
            if rows[j, 0] == a and rows[j, 1] == b and rows[j, 2] == c:
                first[i] = j
                break
            slot = (slot + np.uint64(1)) & mask
    return first


@kernel
def sorted_rows(rows: IntArray, chosen: LongArray) -> IntArray:
    """(M, 3) some rows of (N, 3), the numbers of each in ascending order."""
    ascending = np.empty((len(chosen), 3), np.int32)
    for i in range(len(chosen)):
        a, b, c = rows[chosen[i], 0], rows[chosen[i], 1], rows[chosen[i], 2]
        least, most = min(a, b, c), max(a, b, c)
        ascending[i, 0], ascending[i, 1], ascending[i, 2] = least, max(min(a, b), min(max(a, b), c)), most
    return ascending


@inner_kernel
def _first_half_edges(faces: IntArray, vertex_count: int) -> LongArray:
    """(V + 1,) the first half-edge of every vertex if half-edges are sorted by their smaller end."""
    start = np.zeros(vertex_count + 1, np.int64)
    for f in range(len(faces)):
        for k in range(3):
            start[min(faces[f, k], faces[f, (k + 1) % 3]) + 1] += 1
    for v in range(vertex_count):
        start[v + 1] += start[v]
    return start


class _HalfEdges(NamedTuple):
    """The edges of faces, each by its lower end, in the order of the higher end and then of the faces."""

    start: LongArray  # (V + 1,) the edges with lower end v are start[v] to start[v + 1] - 1
    far_end: IntArray  # (3 F,)
    owner: IntArray  # (3 F,) the face
    forward: BoolArray  # (3 F,) whether the face has the lower end first


@inner_kernel
def _half_edges(faces: IntArray, vertex_count: int) -> _HalfEdges:
    """O(F log D) if D edges at most have one lower end."""
    half_edges = 3 * len(faces)
    start = _first_half_edges(faces, vertex_count)
    far_end = np.empty(half_edges, np.int32)
    owner = np.empty(half_edges, np.int32)
    forward = np.empty(half_edges, np.bool_)
    fill = start[:-1].copy()
    for f in range(len(faces)):
        for k in range(3):
            a, b = faces[f, k], faces[f, (k + 1) % 3]
            low, high = min(a, b), max(a, b)
            p = fill[low]
            if p - start[low] < _FEW:
                # Insertion sort keeps the faces of one edge together and in the order of their indices.
                while p > start[low] and far_end[p - 1] > high:
                    far_end[p], owner[p], forward[p] = far_end[p - 1], owner[p - 1], forward[p - 1]
                    p -= 1
            far_end[p], owner[p], forward[p] = high, f, a < b
            fill[low] += 1
    for v in range(vertex_count):
        begin, end = start[v], start[v + 1]
        if end - begin > _FEW:
            ends, owners, directions = far_end[begin:end].copy(), owner[begin:end].copy(), forward[begin:end].copy()
            order = ascending(ends.astype(np.float64))
            for k in range(end - begin):
                p = order[k]
                far_end[begin + k], owner[begin + k], forward[begin + k] = ends[p], owners[p], directions[p]
    return _HalfEdges(start, far_end, owner, forward)


@kernel
def dual_edges(faces: IntArray, vertex_count: int) -> DualEdges:
    """Pairs of faces (F, 3) that share an edge, ordered by the ends of the edge.

    If m > 2 faces share one edge, they are chained in the order of their indices (m - 1 pairs).
    """
    start, far_end, owner, forward = _half_edges(faces, vertex_count)
    half_edges = 3 * len(faces)
    pairs = np.empty((half_edges, 2), np.int32)
    ends = np.empty((half_edges, 2), np.int32)
    is_manifold = np.empty(half_edges, np.bool_)
    disagrees = np.empty(half_edges, np.bool_)
    count = 0
    for v in range(vertex_count):
        p = start[v]
        while p < start[v + 1]:
            q = p + 1
            while q < start[v + 1] and far_end[q] == far_end[p]:
                q += 1
            for r in range(p, q - 1):
                if owner[r] == owner[r + 1]:
                    continue
                pairs[count, 0], pairs[count, 1] = owner[r], owner[r + 1]
                ends[count, 0], ends[count, 1] = v, far_end[p]
                is_manifold[count] = q - p == 2
                disagrees[count] = forward[r] == forward[r + 1]
                count += 1
            p = q
    return DualEdges(pairs[:count].copy(), ends[:count].copy(), is_manifold[:count].copy(), disagrees[:count].copy())


@kernel
def border_vertices(faces: IntArray, vertex_count: int) -> BoolArray:
    """(V,) True for the ends of edges of exactly one face (F, 3); edges between equal corners do not count."""
    edges = _half_edges(faces, vertex_count)
    border = np.zeros(vertex_count, np.bool_)
    for v in range(vertex_count):
        p = edges.start[v]
        while p < edges.start[v + 1]:
            end = edges.far_end[p]
            q = p + 1
            while q < edges.start[v + 1] and edges.far_end[q] == end:
                q += 1
            if q - p == 1 and end != v:
                border[v] = border[end] = True
            p = q
    return border


@kernel
def consistent_orientation(rows: Rows, dual: DualEdges) -> tuple[IntArray, BoolArray]:
    """Patches of faces that are connected by manifold edges, and the faces to flip within each.

    The first face of a patch keeps its orientation. On a one-sided surface the breadth-first order decides.

    Parameters
    ----------
    rows : the dual edges of every face.

    Returns
    -------
    (F,) the patch 0, 1, ... of every face; (F,) True for faces to flip so that all agree with the first of their patch.
    """
    face_count = len(rows.start) - 1
    patch = np.full(face_count, _EMPTY, np.int32)
    is_flipped = np.zeros(face_count, np.bool_)
    queue = np.empty(face_count, np.int32)
    patches = 0
    for seed in range(face_count):
        if patch[seed] != _EMPTY:
            continue
        patch[seed] = patches
        queue[0] = seed
        head, tail = 0, 1
        while head < tail:
            f = queue[head]
            head += 1
            for p in range(rows.start[f], rows.start[f + 1]):
                g, e = rows.neighbour[p], rows.edge[p]
                if dual.is_manifold[e] and patch[g] == _EMPTY:
                    patch[g] = patches
                    is_flipped[g] = is_flipped[f] != dual.disagrees[e]
                    queue[tail] = g
                    tail += 1
        patches += 1
    return patch, is_flipped


def mesh_edges(faces: IntArray) -> IntArray:
    """(E, 2) the distinct edges of faces (F, 3), the smaller vertex first, in ascending order."""
    pairs = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1).astype(np.int64)
    pairs = pairs[pairs[:, 0] != pairs[:, 1]]
    count = int(faces.max()) + 1
    unique = np.unique(pairs[:, 0] * count + pairs[:, 1])
    return np.stack([unique // count, unique % count], axis=1).astype(np.int32)


def as_bits(positions: FloatArray) -> LongArray:
    """The bit patterns of coordinates, with -0.0 made equal to 0.0."""
    bits: LongArray = (positions + 0.0).view(np.int64)
    return bits
