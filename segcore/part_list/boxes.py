"""Oriented boxes of points: small ones, found by turning a box about the normals of the convex hull."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from segcore.arrays import FloatArray, LongArray, plane_axes, transformed
from segcore.part_list.directions import spread_directions

# All set by hand.
_DIRECTIONS = 128  # of which the extreme points determine the axes; the extents are those of all points
_FEW = 1024  # points from which extreme ones are taken
_CHUNK = 8192  # points that are projected at a time
_ROUNDS = 4  # of turns about each axis of the best box
_BETTER = 1e-3  # least share of the volume that a round has to gain to be followed by another
_FLAT = 1e-7  # share of the largest extent below which another one is rounding error
_PREFERRED = 1.0 - 1e-6  # factor on volumes of boxes along the axes of the coordinates


@dataclass(frozen=True, slots=True, eq=False)
class OrientedBox:
    """A box that holds a part."""

    centre: FloatArray  # (3,)
    axes: FloatArray  # (3, 3) unit vectors as rows, right-handed, along the extents
    extents: FloatArray  # (3,) lengths of the edges, the longest first

    @property
    def diagonal(self) -> float:
        """The length of the diagonal, which is the size of a part."""
        return float(np.linalg.norm(self.extents))


def oriented_box(points: FloatArray, most_normals: int) -> OrientedBox:
    """A box around points (N, 3) whose volume is nearly the least possible.

    Boxes of which one face contains a face of the convex hull are tried, then the best one is turned about its own axes
    until that gains nothing. About a given axis, the least rectangle around the projected points has an edge on an edge
    of their hull.

    Parameters
    ----------
    most_normals : the number of directions of faces of the hull that are tried, those of the largest faces.

    References
    ----------
    J. O'Rourke, Finding minimal enclosing boxes, International Journal of Computer and Information Sciences 14, 1985.
    C.-T. Chang, B. Gorissen, S. Melchior, Fast oriented bounding box optimization on the rotation group SO(3, R), ACM
    Transactions on Graphics 30(5), 2011.
    """
    origin = 0.5 * (points.min(axis=0) + points.max(axis=0))
    centred = points - origin
    axes = _least_axes(_extreme(centred), most_normals)
    along = transformed(centred, axes)
    low, high = along.min(axis=0), along.max(axis=0)
    order = np.argsort(low - high, kind="stable")
    centre = origin + transformed(0.5 * (low + high), axes.T)
    return OrientedBox(centre, _right_handed(axes[order]), (high - low)[order])


def extreme_places(points: FloatArray, count: int) -> LongArray:
    """The places of the points (N, 3) that are farthest in any of ``count`` directions, ascending."""
    directions = np.concatenate([spread_directions(count), np.eye(3), -np.eye(3)])
    best = np.full(len(directions), -np.inf)
    place = np.zeros(len(directions), dtype=np.int64)
    for first in range(0, len(points), _CHUNK):
        heights = directions @ points[first : first + _CHUNK].T
        at = heights.argmax(axis=1)
        height = heights[np.arange(len(directions)), at]
        place[height > best] = first + at[height > best]
        best = np.maximum(best, height)
    return np.unique(place)


def _extreme(points: FloatArray) -> FloatArray:
    return points if len(points) <= _FEW else points[extreme_places(points, _DIRECTIONS)]


def _least_axes(points: FloatArray, most_normals: int) -> FloatArray:
    """(3, 3) the axes of a small box around points, as rows."""
    spread, principal = np.linalg.svd(points - points.mean(axis=0), full_matrices=True)[1:]
    if len(spread) < 3 or spread[2] <= _FLAT * spread[0] or spread[0] == 0.0:
        return _frame(points, principal[2])
    normals = np.concatenate([np.eye(3), principal, _hull_normals(points, most_normals)])
    frames = np.stack([np.eye(3), *(_frame(points, normal) for normal in normals)])
    volumes = np.prod(np.ptp(np.einsum("pj,fkj->fpk", points, frames), axis=1), axis=1)
    volumes[0] *= _PREFERRED
    best = int(np.argmin(volumes))
    axes, volume = frames[best], float(volumes[best])
    for _ in range(_ROUNDS):
        before = volume
        for k in range(3):
            turned = _frame(points, axes[k])
            smaller = float(np.prod(np.ptp(transformed(points, turned), axis=0)))
            if smaller < _PREFERRED * volume:
                axes, volume = turned, smaller
        if volume > (1.0 - _BETTER) * before:
            break
    return axes


def _hull_normals(points: FloatArray, most: int) -> FloatArray:
    """(N, 3) the different normals of the convex hull, those with the largest faces first, at most ``most``."""
    try:
        hull = ConvexHull(points)
    except QhullError:  # the points are nearly in a plane
        return np.empty((0, 3))
    corners = points[hull.simplices]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    normals, which = np.unique(np.round(hull.equations[:, :3], 6), axis=0, return_inverse=True)
    largest = np.argsort(-np.bincount(which.reshape(-1), areas), kind="stable")[:most]
    return normals[largest] / np.linalg.norm(normals[largest], axis=1)[:, None]


def _frame(points: FloatArray, normal: FloatArray) -> FloatArray:
    """(3, 3) the axes of the least box around points with one axis along a normal, as rows."""
    normal = normal / np.linalg.norm(normal)
    basis = plane_axes(normal)
    flat = transformed(points, basis)
    try:
        corners = flat[ConvexHull(flat).vertices]
    except (QhullError, ValueError):  # on a line, or too few
        u = np.linalg.svd(flat - flat.mean(axis=0), full_matrices=True)[2][0]
    else:
        edges = np.roll(corners, -1, axis=0) - corners
        edges /= np.linalg.norm(edges, axis=1)[:, None]
        along, up = corners @ edges.T, corners @ np.stack([-edges[:, 1], edges[:, 0]])
        u = edges[np.argmin(np.ptp(along, axis=0) * np.ptp(up, axis=0))]
    first = u @ basis
    return np.stack([first, np.cross(normal, first), normal])


def _right_handed(axes: FloatArray) -> FloatArray:
    """The axes (3, 3), each with its largest component positive, the last one turned if they are left-handed."""
    largest = axes[np.arange(3), np.abs(axes).argmax(axis=1)]
    turned = axes * np.where(largest < 0, -1.0, 1.0)[:, None]
    turned[2] *= np.sign(np.linalg.det(turned))
    return turned
