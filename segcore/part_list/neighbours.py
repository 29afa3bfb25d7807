"""The common borders of parts: their length, and the plane that fits best."""

from dataclasses import dataclass

import numpy as np

from segcore.array_kernels import distinct_pairs
from segcore.arrays import FloatArray, IntArray, LongArray, group_sums
from segcore.clean.surface import Surface

_STRAIGHT = 1e-6  # extent of a border beside its line, over that along it, which is rounding error


@dataclass(frozen=True, slots=True, eq=False)
class BorderPlane:
    """The plane with the least sum of squared distances from a border."""

    point: FloatArray  # (3,) the centroid of the border
    normal: FloatArray  # (3,) a unit vector, to the side of the neighbour
    largest_deviation: float  # of a point of the border from the plane


@dataclass(frozen=True, slots=True, eq=False)
class Neighbour:
    """A part with a common border."""

    part: int
    length: float  # of the border
    plane: BorderPlane | None  # None if the border is straight, so that many planes fit


def neighbours_of_parts(
    surface: Surface, vertices: FloatArray, labels: IntArray, centres: FloatArray
) -> list[list[Neighbour]]:
    """The neighbours of every part, in the order of their numbers.

    A common border consists of the edges with a face of either part. Parts that touch without common edges, as bodies
    that stand on each other, are no neighbours.

    Parameters
    ----------
    vertices : (V, 3) the positions of the vertices of the surface, in units of the input.
    labels : (F,) the part of every face of the surface.
    centres : (K, 3) of the parts.
    """
    found: list[list[Neighbour]] = [[] for _ in centres]
    sides = labels[surface.edge_faces]
    at = np.flatnonzero(sides[:, 0] != sides[:, 1])
    if len(at) == 0:
        return found
    pairs, of_pair = distinct_pairs(sides[at])
    ends = np.sort(surface.edge_vertices[at], axis=1)
    _, once = np.unique(np.column_stack([of_pair, ends]), axis=0, return_index=True)  # an edge with many faces
    fitted = _fitted(vertices[ends[once]], of_pair[once], len(pairs))
    for (a, b), length, plane in zip(pairs.tolist(), fitted.lengths.tolist(), fitted.planes(), strict=True):
        for part, other in ((a, b), (b, a)):
            found[part].append(Neighbour(other, length, _towards(plane, centres[part], centres[other])))
    return [sorted(list_, key=lambda neighbour: neighbour.part) for list_ in found]


@dataclass(frozen=True, slots=True, eq=False)
class _Fitted:
    lengths: FloatArray  # (P,)
    points: FloatArray  # (P, 3)
    normals: FloatArray  # (P, 3)
    deviations: FloatArray  # (P,)
    is_straight: list[bool]  # P

    def planes(self) -> list[BorderPlane | None]:
        rows = zip(self.points, self.normals, self.deviations.tolist(), self.is_straight, strict=True)
        return [None if straight else BorderPlane(point, normal, most) for point, normal, most, straight in rows]


def _fitted(segments: FloatArray, border: LongArray, count: int) -> _Fitted:
    """The planes of borders, by the exact integrals over their segments (S, 2, 3)."""
    steps, middles = segments[:, 1] - segments[:, 0], segments.mean(axis=1)
    lengths = np.linalg.norm(steps, axis=1)
    total = group_sums(border, lengths, count)
    weight = lengths / np.maximum(total, np.finfo(float).tiny)[border]
    points = np.stack([group_sums(border, weight * middles[:, k], count) for k in range(3)], axis=1)
    around = middles - points[border]
    moments = np.empty((count, 3, 3))
    for i in range(3):
        for j in range(3):
            product = around[:, i] * around[:, j] + steps[:, i] * steps[:, j] / 12.0
            moments[:, i, j] = group_sums(border, weight * product, count)
    values, vectors = np.linalg.eigh(moments)
    normals = vectors[:, :, 0]
    heights = np.abs(np.einsum("sej,sj->se", segments - points[border][:, None], normals[border])).max(axis=1)
    deviations = np.zeros(count)
    np.maximum.at(deviations, border, heights)
    is_straight = values[:, 1] <= _STRAIGHT**2 * values[:, 2]
    return _Fitted(total, points, normals, deviations, is_straight.tolist())


def _towards(plane: BorderPlane | None, here: FloatArray, there: FloatArray) -> BorderPlane | None:
    """The plane with its normal to the side of ``there``."""
    if plane is None or float(plane.normal @ (there - here)) >= 0.0:
        return plane
    return BorderPlane(plane.point, -plane.normal, plane.largest_deviation)
