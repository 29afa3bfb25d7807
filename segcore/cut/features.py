"""Features of a cut, from which a logistic model estimates the share of separated pairs that people keep together.

The Rand index adds up over the splits of a hierarchy. This one number therefore decides which of several cuts of a
segment is the best, which split comes next, and which split to omit.
"""

from typing import NamedTuple

import numpy as np

from segcore.arrays import BoolArray, FloatArray
from segcore.cut.body_features import BodyFeatures, body_features
from segcore.cut.cut_sums import CutSums, SideSums, sums_of_cuts
from segcore.cut.fields import ClusterFields, Segment, SegmentFields, Whole
from segcore.jit.decorators import inner_kernel, kernel

_TINY = 1e-12  # keeps logarithms and quotients finite; far below all values of surfaces of unit size


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
_COUNT = len(FEATURES)


def cut_features(fields: ClusterFields, segment: Segment, inside: SegmentFields, sides: BoolArray) -> FloatArray:
    """(C, M) features of cuts of a segment, in the order of ``FEATURES``.

    Parameters
    ----------
    inside : ``fields.inside(segment)``.
    sides : (C, N) True for the nodes of one side of every cut.
    """
    return _cut_features(inside, sides, fields.whole, segment.depth, segment.parent_ncut)


@kernel
def _cut_features(part: SegmentFields, chosen: BoolArray, whole: Whole, depth: int, parent_ncut: float) -> FloatArray:
    sides, borders = sums_of_cuts(part, chosen, whole.body_area)
    features = np.empty((len(chosen), _COUNT))
    for n in range(len(chosen)):
        k = 0
        for value in _shape_features(sides, borders, n, whole.total, depth, parent_ncut):
            features[n, k] = value
            k += 1
        for value in body_features(sides, borders, n, whole):
            features[n, k] = value
            k += 1
    return features


@inner_kernel
def _shape_features(
    sides: SideSums, borders: CutSums, n: int, total: float, depth: int, parent_ncut: float
) -> CutFeatures:
    size = np.sqrt(total)
    small, large = sides.area[n]
    weight, length = borders.weight[n], borders.border[n]
    ncut = np.log(weight * (1.0 / small + 1.0 / large) * size + _TINY)
    inner, closed, deviation = np.empty(2), np.empty(2), np.empty((2, 2))
    for side in range(2):
        has_edges = sides.length[n, side] > 0.0
        inner[side] = np.log(sides.weight[n, side] / sides.length[n, side]) if has_edges else 0.0
        closed[side] = min(1.0, length / max(sides.degree[n, side] - 2.0 * sides.length[n, side], length))
        for axis in range(2):
            deviation[side, axis] = np.sqrt(sides.variance[n, side, axis] / max(sides.variance[n, side, 2], _TINY))
    parent = np.log(parent_ncut * size) if parent_ncut > 0.0 else 0.0
    affinity = np.log(weight / length)
    border = np.log(length / size)
    thin, thick = sides.thickness[n]
    return CutFeatures(
        ncut,
        np.log(weight / small * size + _TINY),
        np.log(small / total),
        np.log(large / total),
        np.log(small / large),
        affinity,
        affinity - inner[0],
        affinity - inner[1],
        border,
        np.log(length / np.sqrt(small)),
        np.log(length / np.sqrt(large)),
        border - borders.thickness[n],
        closed[0],
        closed[1],
        thin,
        thick,
        borders.thickness[n] - min(thin, thick),
        abs(thin - thick),
        sides.thickness_spread[n, 0],
        sides.thickness_spread[n, 1],
        deviation[0, 0],
        deviation[0, 1],
        deviation[1, 0],
        deviation[1, 1],
        np.log1p(float(depth)),
        parent,
        ncut - parent if parent_ncut > 0.0 else 0.0,
    )
