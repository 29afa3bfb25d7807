"""Matches: open edges of a surface that run along each other, as cracks and T-junctions leave them.

CAD tessellations and booleans leave patches whose borders do not share vertices: they are a small distance apart, or a
corner of one lies on an edge of the other. Two open edges are a *match* if, over the interval in which they lie
beside each other, they are near for their length and their faces continue each other instead of lying on one another.
"""

from typing import NamedTuple

import numpy as np

from segcore.arrays import BoolArray, FloatArray, IntArray, LongArray, pair_keys
from segcore.clean.borders import ends_of
from segcore.clean.near_segments import near_segments
from segcore.clean.topology import DualEdges
from segcore.jit.decorators import kernel

# Set by hand.
LARGEST_GAP = 3e-3  # of the extent, the largest tolerance of a run; matches are found up to twice of it
_LARGEST_SHARE = 0.4  # of the longer edge, the largest gap between two matched edges
_MOST_ENDS = 64  # open edges at one vertex; at a vertex with more, as the tip of a fan, there is no crack
_SMALLEST_OVERLAP = 0.1  # of the shorter edge
_SMALLEST_COSINE = 0.7  # between the directions of two edges
_FOLDED = 0.9  # cosine between the directions from the edges into their faces above which one lies on the other
_DEEPEST = 0.5  # share of the height of a face by which another may overlap it
_BEND = 0.1  # a match at a right angle counts like a flat one with a gap larger by this share of the largest gap


class Matches(NamedTuple):
    """Pairs of open edges that run along each other."""

    edges: IntArray  # (M, 2) the two edges
    ends: IntArray  # (M, 2) the vertices at the two ends of the interval, each an end of one of the edges
    gap: FloatArray  # (M,) largest distance over the interval
    length: FloatArray  # (M,) of the interval
    disagrees: BoolArray  # (M,) both run in the same direction: the orientations of their faces differ

    def select(self, chosen: BoolArray | LongArray) -> "Matches":
        """Return some of the matches, in the order of the selection."""
        return Matches(
            self.edges[chosen], self.ends[chosen], self.gap[chosen], self.length[chosen], self.disagrees[chosen]
        )


def find_matches(vertices: FloatArray, faces: IntArray, dual: DualEdges, borders: IntArray) -> Matches:
    """Pairs of open edges that continue each other; no part of an edge has two partners.

    Of several partners an edge gets the nearest one, and among equally near ones the one that bends least.

    Parameters
    ----------
    vertices : (V, 3) in a box of extent 1.
    borders : (B, 2) face and first corner of every open edge.
    """
    face, corner = borders.T
    ends = ends_of(borders, faces)
    segments = vertices[ends]
    length = np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1)
    pairs = _neighbours(vertices, ends, np.minimum(_LARGEST_SHARE * length, 2 * LARGEST_GAP))
    far = vertices[faces[face, (corner + 2) % 3]]
    candidates, cost, intervals = _measured(pairs, segments, far, ends)
    is_new = _first_of_equals(candidates.edges) & ~are_adjacent(face[candidates.edges], dual.faces, len(faces))
    candidates, cost, intervals = candidates.select(is_new), cost[is_new], intervals[is_new]
    order = np.argsort(cost, kind="stable")
    chosen = _uncovered(candidates.edges[order], intervals[order], len(borders))
    return candidates.select(order[chosen])


def _neighbours(vertices: FloatArray, ends: IntArray, radius: FloatArray) -> LongArray:
    """(P, 2) the pairs of different open edges of which an end of one lies beside the other; pairs may be repeated.

    Neither edge ends at a vertex with more open edges than at a crack.
    """
    is_used = np.zeros(len(vertices), dtype=bool)
    is_used[ends] = True
    ends = (np.cumsum(is_used, dtype=np.int32) - 1)[ends]
    points = vertices[is_used]
    edges_at = np.bincount(ends.ravel(), minlength=len(points))
    searched = np.flatnonzero((edges_at[ends] <= _MOST_ENDS).all(axis=1))
    near = near_segments(points, ends[searched], radius[searched])
    near[:, 0] = searched[near[:, 0]]
    near = near[edges_at[near[:, 1]] <= _MOST_ENDS]
    is_near = np.zeros(len(points), dtype=bool)
    is_near[near[:, 1]] = True
    at = np.flatnonzero(is_near[ends.ravel()])
    at = at[np.argsort(ends.ravel()[at], kind="stable")]
    first, count = np.searchsorted(ends.ravel()[at], near[:, 1]), edges_at[near[:, 1]]
    edge = np.repeat(near[:, 0], count)
    within = np.arange(len(edge)) - np.repeat(np.cumsum(count) - count, count)
    other = at[np.repeat(first, count) + within] // 2
    pairs = np.stack([np.minimum(edge, other), np.maximum(edge, other)], axis=1)
    return pairs[edge != other]


def _first_of_equals(pairs: IntArray) -> BoolArray:
    """(P,) True for the first of all pairs that are equal."""
    _, first = np.unique(pairs[:, 0] * (np.int64(pairs.max(initial=0)) + 1) + pairs[:, 1], return_index=True)
    is_first = np.zeros(len(pairs), dtype=bool)
    is_first[first] = True
    return is_first


def are_adjacent(pairs: IntArray, dual: IntArray, count: int) -> BoolArray:
    """(P,) True for pairs of faces that are the same face or have a dual edge.

    Parameters
    ----------
    dual : (E, 2) the faces of all dual edges.
    count : number of faces.
    """
    asked = np.zeros(count, dtype=bool)
    asked[pairs] = True
    known = dual[asked[dual].all(axis=1)]
    adjacent: BoolArray = np.isin(pair_keys(pairs, count), pair_keys(known, count))
    return adjacent | (pairs[:, 0] == pairs[:, 1])


def _measured(
    pairs: LongArray, segments: FloatArray, far: FloatArray, ends: IntArray
) -> tuple[Matches, FloatArray, FloatArray]:
    """The pairs of edges that match, their costs (M,), and their intervals (M, 2, 2) as shares of both edges."""
    is_match, gap, length, disagrees, bounds, intervals, cost = _measure(pairs, segments, far, ends)
    matches = Matches(pairs.astype(np.int32), bounds, gap, length, disagrees)
    return matches.select(is_match), cost[is_match], intervals[is_match]


@kernel
def _measure(pairs, segments, far, ends):  # type: ignore[no-untyped-def]
    count = len(pairs)
    is_match = np.zeros(count, np.bool_)
    gap, length, cost = np.zeros(count), np.zeros(count), np.zeros(count)
    disagrees = np.zeros(count, np.bool_)
    bounds = np.zeros((count, 2), np.int32)
    intervals = np.zeros((count, 2, 2))
    for i in range(count):
        # The longer edge is the axis that the other is projected to.
        e, g = pairs[i]
        u, v = segments[e, 1] - segments[e, 0], segments[g, 1] - segments[g, 0]
        first, second = np.sqrt((u * u).sum()), np.sqrt((v * v).sum())
        swapped = second > first
        if swapped:
            e, g, u, v, first, second = g, e, v, u, second, first
        if second <= 0.0:
            continue
        along = (u * v).sum() / (first * second)
        if abs(along) < _SMALLEST_COSINE:
            continue
        p = ((segments[g, 0] - segments[e, 0]) * u).sum() / (first * first)
        q = ((segments[g, 1] - segments[e, 0]) * u).sum() / (first * first)
        low, high = max(0.0, min(p, q)), min(1.0, max(p, q))
        if (high - low) * first < _SMALLEST_OVERLAP * second:
            continue
        r, s = (low - p) / (q - p), (high - p) / (q - p)
        at_low = segments[g, 0] + r * v - segments[e, 0] - low * u
        at_high = segments[g, 0] + s * v - segments[e, 0] - high * u
        widest = np.sqrt(max((at_low * at_low).sum(), (at_high * at_high).sum()))
        largest = min(_LARGEST_SHARE * first, 2 * LARGEST_GAP)
        if widest > largest:
            continue
        into = far[e] - segments[e, 0]
        into -= (into * u).sum() / (first * first) * u
        other = far[g] - segments[g, 0]
        other -= (other * v).sum() / (second * second) * v
        height, other_height = np.sqrt((into * into).sum()), np.sqrt((other * other).sum())
        if height <= 0.0 or other_height <= 0.0:
            continue
        cosine = (into * other).sum() / (height * other_height)
        offset = 0.5 * (at_low + at_high)
        depth = max((offset * into).sum() / (height * height), -(offset * other).sum() / (other_height * other_height))
        if cosine > _FOLDED or depth > _DEEPEST:
            continue
        is_match[i] = True
        gap[i], length[i] = widest, (high - low) * first
        cost[i] = widest + _BEND * largest * (1.0 + cosine)
        disagrees[i] = along > 0.0
        begin, end = (0, 1) if p < q else (1, 0)
        bounds[i, 0] = ends[g, begin] if min(p, q) > 0.0 else ends[e, 0]
        bounds[i, 1] = ends[g, end] if max(p, q) < 1.0 else ends[e, 1]
        axis, side = (1, 0) if swapped else (0, 1)
        intervals[i, axis, 0], intervals[i, axis, 1] = low, high
        intervals[i, side, 0], intervals[i, side, 1] = min(r, s), max(r, s)
    return is_match, gap, length, disagrees, bounds, intervals, cost


@kernel
def _uncovered(edges: IntArray, intervals: FloatArray, count: int) -> LongArray:
    """The matches, in their order, of which at least half lies where both edges have no partner yet.

    Parameters
    ----------
    edges : (M, 2) pairs of edges.
    intervals : (M, 2, 2) begin and end of the match on both edges.
    count : number of edges.
    """
    chosen = np.empty(len(edges), np.int64)
    latest = np.full((count, 2), -1, np.int64)  # of every edge the latest match and its side
    before = np.full((len(edges), 2, 2), -1, np.int64)  # of every match and side the one before at the same edge
    accepted = 0
    for m in range(len(edges)):
        is_free = True
        for side in range(2):
            begin, end = intervals[m, side]
            free = end - begin
            i, k = latest[edges[m, side]]
            while i >= 0:
                free -= max(0.0, min(end, intervals[i, k, 1]) - max(begin, intervals[i, k, 0]))
                i, k = before[i, k]
            is_free &= free >= 0.5 * (end - begin)
        if not is_free:
            continue
        for side in range(2):
            edge = edges[m, side]
            before[m, side] = latest[edge]
            latest[edge, 0], latest[edge, 1] = m, side
        chosen[accepted] = m
        accepted += 1
    return chosen[:accepted]
