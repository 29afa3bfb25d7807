"""Borders between parts drawn anew, and parts divided along a stroke, on the faces of a surface.

Everything here is an exact minimum cut between two parts; the other parts do not change.
"""

from collections.abc import Sequence

import numpy as np

from segcore.arrays import BoolArray, FloatArray, IntArray
from segcore.edit.distances import distances_from, distances_from_border, nearest_seed, shortest_path
from segcore.edit.guide_graph import GuideGraph
from segcore.edit.local_cut import minimum_cut
from segcore.errors import InvalidParameters
from segcore.graphs.surface_graph import connected_components
from segcore.label.boundary import BAND

_WIDE = 2 * BAND  # of sqrt(total area), to either side of a border that is drawn anew without a stroke
_SMOOTH = 0.5  # stiffness of borders that are made short, in place of the 0.1 of segcore.label.boundary; set by hand
_ON_STROKE = 0.01  # factor of the cost of a border that follows a stroke; set by hand
_BESIDE = 0.15  # of the length of a stroke: how far beside it faces are on one side for certain; set by hand
_STEPS = 2.5  # least distance beside a stroke, in mean steps between faces; set by hand
_LEAST_KEPT = 0.5  # share of its faces that a part keeps if its borders are made short


def least_border(graph: GuideGraph, labels: IntArray, a: int, b: int) -> IntArray:
    """(F,) labels with the border between the parts a and b at the cheapest place near it."""
    side = labels == a
    pair = side | (labels == b)
    free = _near_border(graph, side, pair, _WIDE * float(np.sqrt(graph.area.sum())))
    return _with_sides(labels, minimum_cut(graph.rows, _within(graph.cost, graph, pair), side, free), pair, a, b)


def border_along(graph: GuideGraph, labels: IntArray, a: int, b: int, stroke: IntArray) -> IntArray:
    """(F,) labels with the border between the parts a and b moved to a stroke.

    The faces of the stroke, and those between it and the border, go to the other part.

    Parameters
    ----------
    stroke : (K,) faces in the order in which they were drawn.
    """
    side = labels == a
    pair = side | (labels == b)
    drawn = _connected(graph, pair, stroke[pair[stroke]])
    if len(drawn) == 0:
        raise InvalidParameters(f"The stroke has no face of the parts {a} and {b}. Draw it on one of them.")
    width = _STEPS * float(graph.step[_touches(graph, drawn)].mean())
    away = _distance_from_pair_border(graph, side, pair)
    near = distances_from(graph.rows, graph.step, drawn, float(away[drawn].max()) + width)
    nearest = nearest_seed(graph.rows, graph.step, pair, drawn)
    free = pair & np.isfinite(near) & (nearest >= 0)
    free &= away <= away[drawn][nearest] + width  # not beyond the stroke
    free[drawn] = False
    moved = side.copy()
    moved[drawn] = ~side[drawn]
    cost = np.maximum(graph.cost, graph.length)  # as dear across a concavity: the stroke is where the border is to be
    cost[_touches(graph, drawn)] *= _ON_STROKE
    return _with_sides(labels, minimum_cut(graph.rows, _within(cost, graph, pair), moved, free), pair, a, b)


def divided(graph: GuideGraph, normals: FloatArray, labels: IntArray, part: int, stroke: IntArray) -> IntArray:
    """(F,) labels with a part divided along a stroke; the smaller side gets the next new label.

    Where the stroke ends, the border goes on along the cheapest way around the part.

    Parameters
    ----------
    normals : (F, 3) of the faces.
    stroke : (K,) faces in the order in which they were drawn.
    """
    region = labels == part
    drawn = _connected(graph, region, stroke[region[stroke]])
    if len(drawn) < 2:
        raise InvalidParameters(f"The stroke has {len(drawn)} faces of part {part}. Draw it across that part.")
    beside = _sides_of_stroke(graph, normals, region, drawn)
    if not (beside > 0).any() or not (beside < 0).any():
        raise InvalidParameters(f"Part {part} has no faces on one side of the stroke. Draw it through the part.")
    cost = graph.cost.copy()
    cost[_touches(graph, drawn)] *= _ON_STROKE
    side = minimum_cut(graph.rows, _within(cost, graph, region), beside > 0, region & (beside == 0))
    first, second = region & side, region & ~side
    smaller = first if graph.area[first].sum() < graph.area[second].sum() else second
    result = labels.copy()
    result[smaller] = int(labels.max()) + 1
    return result


def smoothed(graph: GuideGraph, labels: IntArray, parts: Sequence[int]) -> IntArray:
    """(F,) labels with the borders between some parts made short.

    A part keeps at least half of its faces, and no part falls into more components; a border that does not allow that
    stays as it is.

    Parameters
    ----------
    parts : labels; the borders between two of them are made short.
    """
    labels = labels.copy()
    cost = graph.weight + _SMOOTH * graph.length
    width = BAND * float(np.sqrt(graph.area.sum()))
    ends = labels[graph.edges]
    shared = ends[(ends[:, 0] != ends[:, 1]) & np.isin(ends, parts).all(axis=1)]
    for a, b in np.unique(np.sort(shared, axis=1), axis=0).tolist():
        side = labels == a
        pair = side | (labels == b)
        free = _near_border(graph, side, pair, width)
        after = minimum_cut(graph.rows, _within(cost, graph, pair), side, free)
        if _is_intact(graph, side, after, pair) and _is_intact(graph, pair & ~side, pair & ~after, pair):
            labels = _with_sides(labels, after, pair, a, b)
    return labels


def _is_intact(graph: GuideGraph, before: BoolArray, after: BoolArray, pair: BoolArray) -> bool:
    """Whether a part keeps half of its faces and falls into no more components."""
    kept = np.count_nonzero(before & after & pair) >= _LEAST_KEPT * np.count_nonzero(before)
    return bool(kept) and _components(graph, after & pair) <= _components(graph, before)


def _components(graph: GuideGraph, faces: BoolArray) -> int:
    inside = graph.edges[faces[graph.edges].all(axis=1)]
    return len(np.unique(connected_components(inside, graph.count)[faces]))


def _with_sides(labels: IntArray, side: BoolArray, pair: BoolArray, a: int, b: int) -> IntArray:
    """(F,) labels in which the faces of a pair of parts belong to a or b as a set says."""
    result = labels.copy()
    result[pair] = np.where(side[pair], a, b)
    return result


def _within(cost: FloatArray, graph: GuideGraph, region: BoolArray) -> FloatArray:
    """(E,) costs of the edges inside a region, 0 for the others: borders to other parts do not change."""
    return np.where(region[graph.edges].all(axis=1), cost, 0.0)


def _distance_from_pair_border(
    graph: GuideGraph, side: BoolArray, pair: BoolArray, limit: float = np.inf
) -> FloatArray:
    """(F,) the distance of the faces of two parts from their common border."""
    crossing = graph.edges[pair[graph.edges].all(axis=1) & (side[graph.edges[:, 0]] != side[graph.edges[:, 1]])]
    return distances_from(graph.rows, graph.step, np.unique(crossing), limit)


def _near_border(graph: GuideGraph, side: BoolArray, pair: BoolArray, width: float) -> BoolArray:
    """(F,) the faces of two parts near their common border, but not the innermost ones of either part."""
    near: BoolArray = pair & np.isfinite(_distance_from_pair_border(graph, side, pair, width))
    for part in (side, pair & ~side):
        away = distances_from_border(graph.rows, graph.step, part, np.inf)
        deepest = float(away[np.isfinite(away)].max(initial=0.0))
        near &= ~(part & (away >= 0.5 * deepest))
    return near


def _touches(graph: GuideGraph, faces: IntArray) -> BoolArray:
    """(E,) the edges at some faces."""
    touched = np.zeros(graph.count, dtype=bool)
    touched[faces] = True
    at_faces: BoolArray = touched[graph.edges[:, 0]] | touched[graph.edges[:, 1]]
    return at_faces


def _connected(graph: GuideGraph, region: BoolArray, stroke: IntArray) -> IntArray:
    """The faces of a stroke, with those of the shortest paths between faces that follow each other."""
    pieces = [stroke[:1]]
    for start, end in zip(stroke[:-1].tolist(), stroke[1:].tolist(), strict=True):
        pieces.append(shortest_path(graph.rows, graph.step, region, start, end)[1:])
    return np.concatenate(pieces).astype(np.int32)


def _sides_of_stroke(graph: GuideGraph, normals: FloatArray, region: BoolArray, drawn: IntArray) -> IntArray:
    """(F,) 1 and -1 for the faces of a region that are certainly on the left and on the right of a stroke, else 0."""
    points = graph.points[drawn]
    length = float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
    reach = max(_BESIDE * length, _STEPS * float(graph.step[_touches(graph, drawn)].mean()))
    ahead, behind = (np.clip(np.arange(len(drawn)) + shift, 0, len(drawn) - 1) for shift in (2, -2))
    across = np.cross(normals[drawn], points[ahead] - points[behind])
    nearest = nearest_seed(graph.rows, graph.step, region, drawn)
    away = distances_from(graph.rows, graph.step, drawn, reach)
    at_end = (nearest == 0) | (nearest == len(drawn) - 1)
    beside = region & np.isfinite(away) & (nearest >= 0)
    offset = np.einsum("ij,ij->i", graph.points - points[nearest], across[nearest])
    sides = np.where(beside & ~at_end, np.sign(offset), 0.0).astype(np.int32)
    sides[drawn] = 0
    return sides
