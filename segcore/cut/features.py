"""Features of a cut, from which a logistic model estimates the share of separated pairs that people keep together.

The Rand index adds up over the splits of a hierarchy. This one number therefore decides which of several cuts of a
segment is the best, which split comes next, and which split to omit.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numba import njit

from segcore.arrays import BoolArray, FloatArray
from segcore.cut.body_features import BodyFeatures, body_features
from segcore.cut.fields import ClusterFields, Segment, SegmentFields
from segcore.graphs.cheeger import Cut

_TINY = 1e-12  # keeps logarithms and quotients finite; far below all values of surfaces of unit size

# Columns of the sums over a side; the position takes three columns, the products take nine.
_AREA, _WEIGHT, _LENGTH, _DEGREE, _THICKNESS, _SQUARES, _POSITION, _PRODUCTS = 0, 1, 2, 3, 4, 5, 6, 9


class CutFeatures(NamedTuple):
    """The features of a cut. ``small`` is the side of less area; lengths and areas are relative to the whole surface.

    Affinities are means over borders, weighted by length; thicknesses are means over the area of the logarithm of the
    shape diameter over sqrt(total area).
    """

    ncut: float  # logarithm of the normalized cut times sqrt(total area)
    ncc: float  # logarithm of the normalized Cheeger cut times sqrt(total area)
    small_area: float  # logarithm of the share of the total area
    large_area: float
    balance: float  # logarithm of the ratio of the areas, small over large
    affinity: float  # logarithm of the affinity along the cut
    affinity_contrast_small: float  # the same over the affinity inside the small side
    affinity_contrast_large: float
    border: float  # logarithm of the length of the cut over sqrt(total area)
    border_over_small: float  # logarithm of the length of the cut over the square root of the area of the small side
    border_over_large: float
    border_over_girth: float  # logarithm of the length of the cut over the thickness at the cut
    small_closed: float  # share of the outline of the small side that is this cut, 0 to 1
    large_closed: float
    small_thickness: float
    large_thickness: float
    neck: float  # thickness at the cut less that of the thinner side
    thickness_step: float  # absolute difference of the thicknesses of the sides
    small_thickness_spread: float  # standard deviation
    large_thickness_spread: float
    small_flatness: float  # least over largest standard deviation of the points of the small side
    small_roundness: float  # middle over largest
    large_flatness: float
    large_roundness: float
    depth: float  # logarithm of one more than the number of cuts above
    parent_ncut: float  # ncut of the last cut above; 0 if there is none
    against_parent: float  # ncut less parent_ncut; 0 if there is no cut above


FEATURES = CutFeatures._fields + BodyFeatures._fields


def cut_features(fields: ClusterFields, segment: Segment, inside: SegmentFields, cut: Cut) -> FloatArray:
    """(M,) features of a cut of a segment, in the order of ``FEATURES``.

    Parameters
    ----------
    inside : ``fields.inside(segment)``.
    """
    return np.array([*_shape_features(fields, segment, inside, cut), *body_features(fields, inside, cut)])


def _shape_features(fields: ClusterFields, segment: Segment, inside: SegmentFields, cut: Cut) -> CutFeatures:
    total = fields.graph.total_volume
    size = float(np.sqrt(total))
    graph, small = segment.graph, cut.side if cut.inside <= cut.outside else ~cut.side
    crossing = small[graph.edges[:, 0]] != small[graph.edges[:, 1]]
    length = graph.length[crossing]
    border = float(length.sum())
    one, other = (_side(row, border) for row in _sums_of_sides(inside, small))
    affinity = cut.weight / border
    at_cut = fields.thickness[segment.nodes[graph.edges[crossing]]].mean(axis=1)
    thickness = float((at_cut * length).sum() / border)
    ncut = np.log(cut.ncut * size + _TINY)
    parent = np.log(segment.parent_ncut * size) if segment.parent_ncut > 0 else 0.0
    return CutFeatures(
        ncut=ncut,
        ncc=np.log(cut.ncc * size + _TINY),
        small_area=np.log(one.area / total),
        large_area=np.log(other.area / total),
        balance=np.log(one.area / other.area),
        affinity=np.log(affinity),
        affinity_contrast_small=np.log(affinity / one.affinity),
        affinity_contrast_large=np.log(affinity / other.affinity),
        border=np.log(border / size),
        border_over_small=np.log(border / np.sqrt(one.area)),
        border_over_large=np.log(border / np.sqrt(other.area)),
        border_over_girth=np.log(border / size) - thickness,
        small_closed=one.closed,
        large_closed=other.closed,
        small_thickness=one.thickness,
        large_thickness=other.thickness,
        neck=thickness - min(one.thickness, other.thickness),
        thickness_step=abs(one.thickness - other.thickness),
        small_thickness_spread=one.thickness_spread,
        large_thickness_spread=other.thickness_spread,
        small_flatness=one.flatness,
        small_roundness=one.roundness,
        large_flatness=other.flatness,
        large_roundness=other.roundness,
        depth=np.log1p(segment.depth),
        parent_ncut=parent,
        against_parent=ncut - parent if segment.parent_ncut > 0 else 0.0,
    )


@dataclass(frozen=True, slots=True)
class _Side:
    """One side of a cut."""

    area: float
    affinity: float  # mean over the borders inside, weighted by length; 1 if there are none
    closed: float  # share of its outline that is this cut
    thickness: float  # mean
    thickness_spread: float  # standard deviation
    flatness: float  # least over largest standard deviation of the points
    roundness: float  # middle over largest


def _side(sums: FloatArray, border: float) -> _Side:
    area, weight, length, degree, thickness, squares = sums[:_POSITION].tolist()
    outline = degree - 2.0 * length
    mean = thickness / area
    centre = sums[_POSITION:_PRODUCTS] / area
    variance = np.linalg.eigvalsh(sums[_PRODUCTS:].reshape(3, 3) / area - np.outer(centre, centre))
    deviation = np.sqrt(np.maximum(variance, 0.0)) / np.sqrt(max(variance[2], _TINY))
    return _Side(
        area=area,
        affinity=weight / length if length > 0 else 1.0,
        closed=min(1.0, border / max(outline, border)),
        thickness=mean,
        thickness_spread=float(np.sqrt(max(squares / area - mean**2, 0.0))),
        flatness=float(deviation[0]),
        roundness=float(deviation[1]),
    )


@njit(cache=True)
def _sums_of_sides(fields: SegmentFields, small: BoolArray) -> FloatArray:
    """(2, 18) sums over the small side and over the other one.

    Area; weight and length of the edges inside; degree; and, weighted by area, thickness, its square, the position, and
    the products of its coordinates.
    """
    edges, points = fields.edges, fields.points
    sums = np.zeros((2, _PRODUCTS + 9))
    for e in range(len(edges)):
        a, b = edges[e, 0], edges[e, 1]
        if small[a] == small[b]:
            row = 0 if small[a] else 1
            sums[row, _WEIGHT] += fields.weight[e]
            sums[row, _LENGTH] += fields.length[e]
    for i in range(len(small)):
        row = 0 if small[i] else 1
        v, t, p = fields.volume[i], fields.thickness[i], points[i]
        sums[row, _AREA] += v
        sums[row, _DEGREE] += fields.degree[i]
        sums[row, _THICKNESS] += v * t
        sums[row, _SQUARES] += v * t * t
        for k in range(3):
            sums[row, _POSITION + k] += v * p[k]
            for m in range(3):
                sums[row, _PRODUCTS + 3 * k + m] += v * p[k] * p[m]
    return sums
