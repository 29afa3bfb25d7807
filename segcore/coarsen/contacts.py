"""Contacts between the components of a surface, and the length of the lines along which they touch.

Contacts are measured between points that are spread evenly over the area, so that they depend on the shape and not on
its meshing. Two components touch if points of theirs are closer than one *reach*. The *band* of the contact consists of
the points of either that are more than one reach and at most two from the other. Its area over twice the reach is the
length of the line along which two bodies meet, such as a leg and a seat, and twice the length of a curve in which two
shells cross. A contact is concave if the surfaces of the two bodies face each other.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from segcore.array_kernels import distinct_pairs
from segcore.arrays import FloatArray, IntArray, group_sums
from segcore.clean.surface import Surface
from segcore.jit.decorators import inner_kernel, kernel

POINTS = 32768  # samples of the whole surface; set by hand
# Of the size: components that are closer than this touch. Set by hand: 1.5 times the spacing of the points, which is
# sqrt(1 / POINTS) = 1 / 181 of the size, so that points of two surfaces in contact find each other.
REACH = 1 / 120
_LAYER = 0.1  # of the size: layers that lie on each other count as a border of length area / this; set by hand
_MOST_PARTNERS = 8  # components that one point can touch; a limit of memory
# The additive recurrence of Roberts, The unreasonable effectiveness of quasirandom sequences: evenly spread points in a
# square for any number of points.
_R2 = (0.7548776662466927, 0.5698402909980532)


@dataclass(frozen=True, slots=True, eq=False)
class SurfacePoints:
    """Points spread evenly over the area of a surface."""

    position: FloatArray  # (P, 3)
    face: IntArray  # (P,)
    normal: FloatArray  # (P, 3) of the face
    area: FloatArray  # (P,) of the piece of surface that a point represents


@dataclass(frozen=True, slots=True, eq=False)
class Links:
    """Pairs of faces of different components that belong together; pairs may be repeated."""

    faces: IntArray  # (C, 2)
    length: FloatArray  # (C,) of the border that a pair represents, > 0, in units of the surface
    # (C,) mean cosine between the normals and the directions to the other face, -1..1: positive where the surfaces face
    # each other, negative where the bodies run into each other, 0 where one surface continues or covers the other
    concavity: FloatArray

    @classmethod
    def none(cls) -> "Links":
        """No pairs."""
        return cls(np.empty((0, 2), dtype=np.int32), np.empty(0), np.empty(0))


def spread_points(surface: Surface, component: IntArray, count: int) -> SurfacePoints:
    """About ``count`` points in proportion to area, and at least one on every component.

    Parameters
    ----------
    component : (F,) the component of every face.
    """
    order = np.argsort(component, kind="stable")
    area = surface.areas[order]
    total = area.sum()
    if total <= 0.0:
        area, total = np.ones(len(area)), float(len(area))
    until = np.cumsum(area) * (count / total)
    # All faces lie one after the other on a line of length count. A component gets the points k with k + 1/2 in its
    # interval of the line, or one in the middle of it if there are none.
    last = np.flatnonzero(np.append(np.diff(component[order]) != 0, True))
    end = until[last]
    begin = np.concatenate([[0.0], end[:-1]])
    points = np.maximum(np.ceil(end - 0.5) - np.ceil(begin - 0.5), 1.0).astype(np.int64)
    interval = np.repeat(np.arange(len(points)), points)
    within = np.arange(points.sum()) - np.repeat(np.cumsum(points) - points, points)
    at = begin[interval] + (within + 0.5) * ((end - begin) / points)[interval]
    face = order[np.minimum(np.searchsorted(until, at, side="right"), last[interval])].astype(np.int32)
    share = ((end - begin) / points)[interval] * (total / count)
    return SurfacePoints(_inside(surface.vertices[surface.faces[face]]), face, surface.normals[face], share)


def _inside(corners: FloatArray) -> FloatArray:
    """(P, 3) a point in each of the triangles (P, 3, 3)."""
    index = np.arange(1, len(corners) + 1)
    u, v = (index * _R2[0]) % 1.0, (index * _R2[1]) % 1.0
    beyond = u + v > 1.0
    u, v = np.where(beyond, 1.0 - u, u), np.where(beyond, 1.0 - v, v)
    a, b, c = corners.transpose(1, 0, 2)
    inside: FloatArray = a + u[:, None] * (b - a) + v[:, None] * (c - a)
    return inside


def find_contacts(points: SurfacePoints, component: IntArray, size: float) -> Links:
    """The contacts between components, as links whose lengths sum to that of the contacts.

    Between two components with the least distance d and the areas B of the band and N within reach, lengths sum to
    (1 - (d / reach)**2) min(1, N / B) B / (2 reach) + N / (2 layer), where a layer is a tenth of the size. The first
    term vanishes with the contact, the second one connects layers that lie on each other.

    Parameters
    ----------
    component : (P,) the component of every point.
    size : of the surface, the unit of reach and layer: sqrt(total area), or its extent if that is less.
    """
    reach = REACH * size
    pair, distance = _partners(points.position, component, 2 * reach)
    area = points.area[pair[:, 0]]
    _, of_pair = distinct_pairs(component[pair])
    near = distance <= reach
    band, within = group_sums(of_pair, area * ~near), group_sums(of_pair, area * near)
    least = np.full(len(band), np.inf)
    np.minimum.at(least, of_pair, distance)
    closeness = np.maximum(0.0, 1.0 - (least / reach) ** 2)
    share = closeness * np.divide(np.minimum(within, band), band, out=np.zeros(len(band)), where=band > 0.0)
    length = area * np.where(near, 0.5 / (_LAYER * size), share[of_pair] * (0.5 / reach))
    touching = length > 0.0
    pair, length, distance = pair[touching], length[touching], distance[touching]
    return Links(points.face[pair], length, _concavity(points, pair, distance))


def _concavity(points: SurfacePoints, pair: IntArray, distance: FloatArray) -> FloatArray:
    """(C,) the concavity of ``Links`` for pairs (C, 2) of points at distances (C,)."""
    position, normal = points.position[pair], points.normal[pair]
    ahead = np.einsum("ck,ck->c", position[:, 1] - position[:, 0], normal[:, 0] - normal[:, 1])
    concavity: FloatArray = np.divide(0.5 * ahead, distance, out=np.zeros(len(pair)), where=distance > 0.0)
    return concavity


class _Found(NamedTuple):
    """Pairs of points that have been found so far; the arrays have room for all."""

    pairs: IntArray  # (P * 8, 2) a point, and the nearest point of another component
    squared: FloatArray  # (P * 8,) their squared distance


def _partners(position: FloatArray, component: IntArray, radius: float) -> tuple[IntArray, FloatArray]:
    """Pairs (C, 2) and distances (C,): for every point the nearest one of each other component within a radius."""
    cell = np.floor((position - position.min(axis=0)) / radius).astype(np.int64) + 1
    key = (cell[:, 0] << 42) | (cell[:, 1] << 21) | cell[:, 2]
    order = np.argsort(key, kind="stable")
    pairs, distance = _pairs_in_cells(position[order], component[order], key[order], radius * radius)
    return order[pairs].astype(np.int32), distance


@kernel
def _pairs_in_cells(position, component, key, squared_radius):  # type: ignore[no-untyped-def]
    """The search of ``_partners`` among points that are sorted by the keys of their cells."""
    count = len(position)
    found = _Found(np.empty((count * _MOST_PARTNERS, 2), dtype=np.int32), np.empty(count * _MOST_PARTNERS))
    used = 0
    for i in range(count):
        first = used
        for dx in range(-1, 2):
            for dy in range(-1, 2):
                centre = key[i] + (dx << 42) + (dy << 21)
                j = np.searchsorted(key, centre - 1)
                while j < count and key[j] <= centre + 1:
                    if component[j] != component[i]:
                        squared = 0.0
                        for axis in range(3):
                            squared += (position[i, axis] - position[j, axis]) ** 2
                        if squared <= squared_radius:
                            used = _keep_nearest(found, component, first, used, i, j, squared)
                    j += 1
    return found.pairs[:used].copy(), np.sqrt(found.squared[:used])


@inner_kernel
def _keep_nearest(found, component, first, used, i, j, squared):  # type: ignore[no-untyped-def]
    """Enter j as the partner of i if it is the nearest point of its component; return the number of pairs then.

    The pairs first..used - 1 are those of i.
    """
    for k in range(first, used):
        if component[found.pairs[k, 1]] == component[j]:
            if squared < found.squared[k]:
                found.pairs[k, 1] = j
                found.squared[k] = squared
            return used
    if used - first == _MOST_PARTNERS:
        return used
    found.pairs[used, 0] = i
    found.pairs[used, 1] = j
    found.squared[used] = squared
    return used + 1
