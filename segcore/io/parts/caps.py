"""Caps: triangles that close the border of a piece of a surface."""

from dataclasses import dataclass

import numpy as np
from numba import njit

from segcore.arrays import BoolArray, FloatArray, IntArray, LongArray, transformed

# The number of ears, each with a shorter base than the one before, that end the search. Set by hand: one is enough for
# a valid cap, more avoid long thin triangles.
_IMPROVEMENTS = 8


@dataclass(frozen=True, slots=True, eq=False)
class Capped:
    """Faces without a border."""

    vertices: FloatArray  # (V', 3) the given vertices, then the centres of caps
    faces: IntArray  # (F', 3) the given faces, then the caps


def close_borders(vertices: FloatArray, faces: IntArray) -> Capped:
    """Close each border loop of a set of faces with a cap.

    The border is that of the faces as a chain: uses of an edge in opposite directions cancel. What remains enters and
    leaves each vertex equally often, so it consists of closed loops. A loop is triangulated by ear clipping in the
    plane that fits it best. If that would add an edge that exists already, the cap is a fan around the centre of the
    loop instead, so that no edge with fewer faces gets more than two.

    References
    ----------
    Meisters, Polygons have ears, 1975. Newell's normal: Sutherland, Sproull and Schumacker, A characterization of ten
    hidden-surface algorithms, 1974.
    """
    loops = border_loops(faces)
    taken = _edges_between(faces, loops)
    centres: list[FloatArray] = []
    caps = [faces]
    for loop in loops:
        cap: IntArray = loop[cut_ears(_projected(vertices[loop]))]
        inner = _inner_edges(cap, loop)
        if len(inner) < len(cap) - 1 or not taken.isdisjoint(inner):
            centre = np.full(len(loop), len(vertices) + len(centres), dtype=np.int32)
            centres.append(vertices[loop].mean(axis=0))
            cap = np.stack([loop, np.roll(loop, -1), centre], axis=1)
        else:
            taken |= inner
        caps.append(cap)
    return Capped(np.vstack([vertices, *centres]), np.concatenate(caps).astype(np.int32))


def _edges_between(faces: IntArray, loops: list[IntArray]) -> set[tuple[int, int]]:
    """The edges of faces that have both ends on loops, lower vertex first."""
    on_loop = np.zeros(int(faces.max()) + 1, dtype=bool)
    for loop in loops:
        on_loop[loop] = True
    ends = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    return set(map(tuple, ends[on_loop[ends].all(axis=1)].tolist()))


def _inner_edges(cap: IntArray, loop: IntArray) -> set[tuple[int, int]]:
    """The edges of a cap that are not edges of its loop, lower vertex first."""
    ends = np.sort(cap[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    rim = np.sort(np.stack([loop, np.roll(loop, -1)], axis=1), axis=1)
    return set(map(tuple, ends.tolist())) - set(map(tuple, rim.tolist()))


def border_loops(faces: IntArray) -> list[IntArray]:
    """The closed loops of the border, without repeated vertices, in the direction opposite to that of the faces."""
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
    low_first = ends[:, 0] < ends[:, 1]
    pairs, which = np.unique(np.sort(ends, axis=1), axis=0, return_inverse=True)
    surplus = np.bincount(which.reshape(-1), np.where(low_first, 1.0, -1.0), len(pairs)).astype(np.int64)
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


def _projected(points: FloatArray) -> FloatArray:
    """(N, 2) the points of a loop in the plane with Newell's normal, counter-clockwise."""
    relative = points - points.mean(axis=0)
    normal = np.cross(relative, np.roll(relative, -1, axis=0)).sum(axis=0)
    size = float(np.linalg.norm(normal))
    normal = normal / size if size > 0 else np.array([0.0, 0.0, 1.0])
    across = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
    across /= np.linalg.norm(across)
    return transformed(relative, np.stack([across, np.cross(normal, across)]))


@njit(cache=True)
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


@njit(cache=True)
def _is_ear(points: FloatArray, after: LongArray, a: int, b: int, c: int) -> bool:
    if _turn(points, a, b, c) <= 0:
        return False
    p = after[c]
    while p != a:
        if _turn(points, a, b, p) >= 0 and _turn(points, b, c, p) >= 0 and _turn(points, c, a, p) >= 0:
            return False
        p = after[p]
    return True


@njit(cache=True)
def _turn(points: FloatArray, a: int, b: int, c: int) -> float:
    """Twice the signed area of a triangle."""
    return (points[b, 0] - points[a, 0]) * (points[c, 1] - points[a, 1]) - (points[b, 1] - points[a, 1]) * (
        points[c, 0] - points[a, 0]
    )
