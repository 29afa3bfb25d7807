"""The closed loops of the border of a set of faces."""

import numpy as np

from segcore.array_kernels import distinct_pairs
from segcore.arrays import BoolArray, IntArray


def border_loops(faces: IntArray) -> list[IntArray]:
    """The closed loops of the border, without repeated vertices, in the direction opposite to that of the faces.

    The border is that of the faces as a chain: uses of an edge in opposite directions cancel. What remains enters and
    leaves each vertex equally often, so it consists of closed loops.
    """
    edges = _border_edges(faces)
    order = np.argsort(edges[:, 0], kind="stable")
    edges = edges[order]
    loops: list[IntArray] = []
    used = np.zeros(len(edges), dtype=bool)
    next_edge = {int(start): at for at, start in reversed(list(enumerate(edges[:, 0])))}
    for first in range(len(edges)):
        if not used[first]:
            loops += _simple_loops(_walk(edges, next_edge, used, first))
    return loops


def _border_edges(faces: IntArray) -> IntArray:
    """(B, 2) the directed edges that cancel the border, each repeated as often as it remains."""
    ends = faces[:, [[1, 0], [2, 1], [0, 2]]].reshape(-1, 2)
    ends = ends[ends[:, 0] != ends[:, 1]]
    pairs, which = distinct_pairs(ends)
    surplus = np.bincount(which, np.where(ends[:, 0] < ends[:, 1], 1.0, -1.0), len(pairs)).astype(np.int64)
    directed = np.where(surplus[:, None] > 0, pairs, pairs[:, ::-1])
    edges: IntArray = np.repeat(directed, np.abs(surplus), axis=0).astype(np.int32)
    return edges


def _walk(edges: IntArray, next_edge: dict[int, int], used: BoolArray, first: int) -> list[int]:
    """The vertices of a closed walk from edge ``first`` over unused edges, which are marked as used."""
    walk, at = [], first
    while at < len(edges) and not used[at]:
        used[at] = True
        start, end = edges[at].tolist()
        walk.append(start)
        next_edge[start] = at + 1
        at = next_edge[end]
        if at == len(edges) or edges[at, 0] != end:
            break  # the walk is back at its start, and no unused edge leaves it
    return walk


def _simple_loops(walk: list[int]) -> list[IntArray]:
    """Split a closed walk at repeated vertices; loops of two vertices, back along the same edge, are dropped."""
    loops: list[list[int]] = []
    path: list[int] = []
    position: dict[int, int] = {}
    for vertex in walk:
        if vertex in position:
            begin = position[vertex]
            loops.append(path[begin:])
            for left in path[begin:]:
                del position[left]
            del path[begin:]
        position[vertex] = len(path)
        path.append(vertex)
    return [np.array(loop, dtype=np.int32) for loop in [*loops, path] if len(loop) > 2]
