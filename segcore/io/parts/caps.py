"""Caps: triangles that close the border of a piece of a surface."""

from dataclasses import dataclass

import numpy as np

from segcore.arrays import FloatArray, IntArray, LongArray
from segcore.io.parts.borders import border_loops
from segcore.io.parts.joints import Cap, Inside, caps_of


@dataclass(frozen=True, slots=True, eq=False)
class Capped:
    """Faces without a border."""

    vertices: FloatArray  # (V', 3) the given vertices, then those in caps
    faces: IntArray  # (F', 3) the given faces, then the caps


def close_borders(vertices: FloatArray, faces: IntArray, is_inside: Inside) -> Capped:
    """Close each border loop of a set of faces with a cap; loops around a bore are closed together with an outer loop.

    See :mod:`segcore.io.parts.borders`, :mod:`segcore.io.parts.joints` and :mod:`segcore.io.parts.triangulation`. An
    edge of a cap that exists already gets a vertex in its middle, so that no edge with fewer faces gets more than two.

    Parameters
    ----------
    is_inside : tells which points are inside the whole model, of which the faces are a part.
    """
    loops = border_loops(faces)
    taken = _edges_between(faces, loops)
    points, triangles = [vertices], [faces]
    count = len(vertices)
    for cap in caps_of(vertices, loops, is_inside):
        added, of_cap = _with_new_edges(vertices, cap, taken, count)
        points.append(added)
        triangles.append(of_cap)
        count += len(added)
    return Capped(np.concatenate(points), np.concatenate(triangles).astype(np.int32))


def _edges_between(faces: IntArray, loops: list[IntArray]) -> set[tuple[int, int]]:
    """The edges of faces that have both ends on loops, lower vertex first."""
    on_loop = np.zeros(int(faces.max()) + 1, dtype=bool)
    for loop in loops:
        on_loop[loop] = True
    ends = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    return set(map(tuple, ends[on_loop[ends].all(axis=1)].tolist()))


def _with_new_edges(
    vertices: FloatArray, cap: Cap, taken: set[tuple[int, int]], first: int
) -> tuple[FloatArray, IntArray]:
    """New vertices, numbered from ``first``, and the triangles of a cap; its new edges are added to ``taken``."""
    number = cap.loop.tolist()
    triangles = _Triangles(cap.triangles)
    added: list[FloatArray] = []
    for places in [*_bridges(number), *_inner_edges(cap.triangles, len(number))]:
        edge = _lower_first(*(number[corner] for corner in places[0]))
        if edge in taken:
            for place in places:
                triangles.split(place, len(number))
            number.append(first + len(added))
            added.append(0.5 * (vertices[edge[0]] + vertices[edge[1]]))
        taken.add(edge)
    return np.array(added).reshape(-1, 3), np.array(number, dtype=np.int32)[np.array(triangles.corners)]


class _Triangles:
    """Triangles of which edges can be split."""

    def __init__(self, triangles: LongArray) -> None:
        self.corners: list[list[int]] = triangles.tolist()
        self._at_edge: dict[tuple[int, int], int] = {}  # the triangle on the left of a directed edge
        for triangle in range(len(self.corners)):
            self._enter(triangle)

    def _enter(self, triangle: int) -> None:
        a, b, c = self.corners[triangle]
        self._at_edge |= dict.fromkeys([(a, b), (b, c), (c, a)], triangle)

    def split(self, edge: tuple[int, int], middle: int) -> None:
        """Put a new corner in the middle of an edge, in the triangles on both sides of it."""
        for x, y in (edge, edge[::-1]):
            if (x, y) in self._at_edge:
                triangle = self._at_edge.pop((x, y))
                (z,) = set(self.corners[triangle]) - {x, y}
                self.corners[triangle] = [x, middle, z]
                self.corners.append([middle, y, z])
                self._enter(triangle)
                self._enter(len(self.corners) - 1)


def _inner_edges(triangles: LongArray, count: int) -> list[list[tuple[int, int]]]:
    """The edges between corners of a loop that do not follow each other, each as a list of one pair of corners."""
    ends = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    ends = ends[~np.isin(ends[:, 1] - ends[:, 0], (1, count - 1))]
    return [[(a, b)] for a, b in sorted(set(map(tuple, ends.tolist())))]


def _bridges(number: list[int]) -> list[list[tuple[int, int]]]:
    """The edges that a loop of vertices follows in both directions, as the two pairs of corners."""
    corners = range(len(number))
    pairs = list(zip(corners, [*corners[1:], 0], strict=True))
    place = {(number[a], number[b]): (a, b) for a, b in pairs}
    return [
        [(a, b), place[number[b], number[a]]] for a, b in pairs if a < place.get((number[b], number[a]), (-1, 0))[0]
    ]


def _lower_first(a: int, b: int) -> tuple[int, int]:
    return (a, b) if a < b else (b, a)
