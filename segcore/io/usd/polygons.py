"""The polygons of a file, put together from the faces that they were divided into."""

from dataclasses import dataclass

import numpy as np

from segcore.arrays import IntArray, LongArray


@dataclass(frozen=True, slots=True, eq=False)
class CornerLoops:
    """Polygons in the order of the faces, given by their corners."""

    corners: LongArray  # (sum of sizes,) corners of all polygons, concatenated; corner k of face f is 3 f + k
    sizes: LongArray  # (P,)
    first_face: LongArray  # (P,)


def corner_loops(faces: IntArray, source_polygon: IntArray | None, part: IntArray) -> CornerLoops:
    """Return the polygons that the faces were divided from.

    Faces stay triangles if their polygon has faces of several parts, or if its border is not one loop.

    Parameters
    ----------
    faces : (F, 3).
    source_polygon : (F,) the polygon of each face; None if every polygon is one face.
    part : (F,) the part of every face.
    """
    count = len(faces)
    if source_polygon is None:
        return CornerLoops(np.arange(3 * count), np.full(count, 3), np.arange(count))
    same = source_polygon[1:] == source_polygon[:-1]
    polygon = np.cumsum(np.concatenate([[0], ~same]))
    size = np.bincount(polygon)
    start = np.cumsum(size) - size
    stays, is_fan = np.zeros(len(size), dtype=bool), np.ones(len(size), dtype=bool)
    stays[polygon[1:][same & (part[1:] != part[:-1])]] = True
    is_fan[polygon[1:][same & ((faces[1:, 0] != faces[:-1, 0]) | (faces[1:, 1] != faces[:-1, 2]))]] = False
    loops: dict[int, list[int]] = {}
    for number in np.flatnonzero(~is_fan & ~stays).tolist():  # concave polygons
        first = int(start[number])
        loop = _loop(faces[first : first + int(size[number])].tolist())
        if loop:
            loops[first] = [3 * first + corner for corner in loop]
        else:
            stays[number] = True
    continues = np.concatenate([[False], same & ~stays[polygon[1:]]])
    is_kept = np.ones((count, 3), dtype=bool)
    is_kept[continues, :2] = False  # a further face of a fan adds its last corner
    corners, begin = np.flatnonzero(is_kept), np.flatnonzero(~continues)
    sizes = np.diff(begin, append=count) + 2
    for first, loop in loops.items():
        place = int(np.searchsorted(corners, 3 * first))
        corners[place : place + len(loop)] = loop
    return CornerLoops(corners, sizes, begin)


def _loop(faces: list[list[int]]) -> list[int] | None:
    """The corners around some faces, numbered 3 f + k; None if their border is not one loop through all vertices."""
    edges = {(face[k], face[(k + 1) % 3]): 3 * f + k for f, face in enumerate(faces) for k in range(3)}
    border = {tail: (head, corner) for (tail, head), corner in edges.items() if (head, tail) not in edges}
    vertex = next(iter(border), -1)
    loop: list[int] = []
    while vertex in border:
        vertex, corner = border.pop(vertex)
        loop.append(corner)
    return loop if len(loop) == len(faces) + 2 and not border else None
