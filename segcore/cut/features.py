"""Features of a cut, from which a logistic model estimates the share of separated pairs that people keep together.

The Rand index adds up over the splits of a hierarchy. This one number therefore decides which of several cuts of a
segment is the best, which split comes next, and which split to omit.
"""

from collections.abc import Sequence
from typing import NamedTuple, TypeAlias

import numpy as np

from segcore.arrays import FloatArray
from segcore.cut.body_features import BodyFeatures, body_features
from segcore.cut.cut_sums import CutSums, SideSums, sums_of_cuts
from segcore.cut.fields import ClusterFields, Segment, SegmentFields
from segcore.graphs.cheeger import Cut

_TINY = 1e-12  # keeps logarithms and quotients finite; far below all values of surfaces of unit size


Column: TypeAlias = FloatArray | float  # (N,) of every cut, or one value for all of them


class CutFeatures(NamedTuple):
    """The features of N cuts. ``small`` is the side of less area; lengths and areas are relative to the whole surface.

    Affinities are means over borders, weighted by length; thicknesses are means over the area of the logarithm of the
    shape diameter over sqrt(total area).
    """

    ncut: Column  # logarithm of the normalized cut times sqrt(total area)
    ncc: Column  # logarithm of the normalized Cheeger cut times sqrt(total area)
    small_area: Column  # logarithm of the share of the total area
    large_area: Column
    balance: Column  # logarithm of the ratio of the areas, small over large
    affinity: Column  # logarithm of the affinity along the cut
    affinity_contrast_small: Column  # the same over the affinity inside the small side
    affinity_contrast_large: Column
    border: Column  # logarithm of the length of the cut over sqrt(total area)
    border_over_small: Column  # logarithm of the length of the cut over the square root of the area of the small side
    border_over_large: Column
    border_over_girth: Column  # logarithm of the length of the cut over the thickness at the cut
    small_closed: Column  # share of the outline of the small side that is this cut, 0 to 1
    large_closed: Column
    small_thickness: Column
    large_thickness: Column
    neck: Column  # thickness at the cut less that of the thinner side
    thickness_step: Column  # absolute difference of the thicknesses of the sides
    small_thickness_spread: Column  # standard deviation
    large_thickness_spread: Column
    small_flatness: Column  # least over largest standard deviation of the points of the small side
    small_roundness: Column  # middle over largest
    large_flatness: Column
    large_roundness: Column
    depth: Column  # logarithm of one more than the number of cuts above
    parent_ncut: Column  # ncut of the last cut above; 0 if there is none
    against_parent: Column  # ncut less parent_ncut; 0 if there is no cut above


FEATURES = CutFeatures._fields + BodyFeatures._fields


def cut_features(fields: ClusterFields, segment: Segment, inside: SegmentFields, cuts: Sequence[Cut]) -> FloatArray:
    """(N, M) features of cuts of a segment, in the order of ``FEATURES``.

    Parameters
    ----------
    inside : ``fields.inside(segment)``.
    """
    small = np.stack([cut.side if cut.inside <= cut.outside else ~cut.side for cut in cuts])
    sides, borders = sums_of_cuts(inside, small, fields.bodies.area)
    columns = (*_shape_features(fields, segment, cuts, sides, borders), *body_features(fields, sides, borders))
    features = np.empty((len(cuts), len(FEATURES)))
    for k, column in enumerate(columns):
        features[:, k] = column
    return features


def _shape_features(
    fields: ClusterFields, segment: Segment, cuts: Sequence[Cut], sides: SideSums, borders: CutSums
) -> CutFeatures:
    total = fields.graph.total_volume
    size = float(np.sqrt(total))
    small, large = sides.area.T / total
    root = np.sqrt(sides.area)
    ncut = np.log(np.array([cut.ncut for cut in cuts]) * size + _TINY)
    parent = np.log(segment.parent_ncut * size) if segment.parent_ncut > 0 else 0.0
    affinity = np.array([cut.weight for cut in cuts]) / borders.border
    inner = np.divide(sides.weight, sides.length, out=np.ones_like(sides.weight), where=sides.length > 0.0)
    border = np.log(borders.border / size)
    outline = np.maximum(sides.degree - 2.0 * sides.length, borders.border[:, None])
    closed = np.minimum(1.0, borders.border[:, None] / outline)
    deviation = np.sqrt(sides.variance / np.maximum(sides.variance[:, :, 2:], _TINY))
    return CutFeatures(
        ncut=ncut,
        ncc=np.log(np.array([cut.ncc for cut in cuts]) * size + _TINY),
        small_area=np.log(small),
        large_area=np.log(large),
        balance=np.log(small / large),
        affinity=np.log(affinity),
        affinity_contrast_small=np.log(affinity / inner[:, 0]),
        affinity_contrast_large=np.log(affinity / inner[:, 1]),
        border=border,
        border_over_small=np.log(borders.border / root[:, 0]),
        border_over_large=np.log(borders.border / root[:, 1]),
        border_over_girth=border - borders.thickness,
        small_closed=closed[:, 0],
        large_closed=closed[:, 1],
        small_thickness=sides.thickness[:, 0],
        large_thickness=sides.thickness[:, 1],
        neck=borders.thickness - sides.thickness.min(axis=1),
        thickness_step=np.abs(sides.thickness[:, 0] - sides.thickness[:, 1]),
        small_thickness_spread=sides.thickness_spread[:, 0],
        large_thickness_spread=sides.thickness_spread[:, 1],
        small_flatness=deviation[:, 0, 0],
        small_roundness=deviation[:, 0, 1],
        large_flatness=deviation[:, 1, 0],
        large_roundness=deviation[:, 1, 1],
        depth=np.log1p(segment.depth),
        parent_ncut=parent,
        against_parent=ncut - parent if segment.parent_ncut > 0 else 0.0,
    )
