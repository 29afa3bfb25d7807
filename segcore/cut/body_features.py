"""Features of what a cut does to the bodies of a segment, and of how its sides stand to each other."""

from typing import NamedTuple

import numpy as np
from numba import njit

from segcore.arrays import BoolArray, FloatArray
from segcore.cut.fields import ClusterFields, SegmentFields
from segcore.graphs.cheeger import Cut

_TINY = 1e-12  # keeps logarithms and quotients finite; far below all values of surfaces of unit size
_LEAST_CONTACT = 1e-4  # of the square root of an area: a contact of this length counts as none; set by hand
_WHOLE = 1.0 - 1e-9  # share of a body that counts as all of it

# Columns of the sums over a side; the centroid takes three columns, the products take nine.
_AREA, _OPEN, _CONFIDENCE, _CENTRE, _PRODUCTS = 0, 1, 2, 3, 6


class BodyFeatures(NamedTuple):
    """Features of a cut beside those of its shape. ``small`` is the side of less area."""

    contact_share: float  # share of the length of the cut that is contact between bodies
    contact_over_small: float  # logarithm of the length of the contact over sqrt(area of the small side)
    small_pieces: float  # logarithm of one more than the number of pieces that have a part in the small side
    large_pieces: float
    divided: float  # share of the area of the segment in pieces that the cut divides
    small_whole: float  # share of the area of the small side in whole bodies
    large_whole: float
    small_of_body: float  # logarithm of the share of the small side in the area of the bodies that it has a part of
    small_inside: float  # share of the area of the small side inside the box around the large side
    centre_distance: float  # logarithm of the distance of the centroids over sqrt(area of the small side)
    small_compactness: float  # logarithm of the area over the total variance of the points
    large_compactness: float
    small_open: float  # logarithm of one more than the length of open borders over sqrt(area)
    large_open: float
    small_confidence: float  # share of the rays of the thickness that met the other side from inside
    large_confidence: float
    repeats: float  # logarithm of the number of bodies like the small side, if that is one whole body; 0 otherwise
    flat_share: float  # share of the length of the cut that runs between coplanar faces
    bodies: float  # logarithm of the number of bodies of the whole surface
    mean_affinity: float  # logarithm of the mean affinity inside the bodies of the whole surface


def body_features(fields: ClusterFields, part: SegmentFields, cut: Cut) -> BodyFeatures:
    """The features of a cut of a segment with the fields ``part``."""
    small = cut.side if cut.inside <= cut.outside else ~cut.side
    bodies = fields.bodies
    border, contact, flat = _sums_of_cut(part, small)
    one, other = _sums_of_sides(part, small)
    small_pieces, large_pieces, divided = _pieces(part, small)
    small_whole, large_whole, touched, only = _bodies(part, small, bodies.area)
    inside = _area_in_box(part, small, other)
    step = one[_CENTRE:_PRODUCTS] - other[_CENTRE:_PRODUCTS]
    return BodyFeatures(
        contact_share=contact / border,
        contact_over_small=np.log(contact / np.sqrt(one[_AREA]) + _LEAST_CONTACT),
        small_pieces=np.log1p(small_pieces),
        large_pieces=np.log1p(large_pieces),
        divided=divided / (one[_AREA] + other[_AREA]),
        small_whole=small_whole / one[_AREA],
        large_whole=large_whole / other[_AREA],
        small_of_body=np.log(one[_AREA] / touched),
        small_inside=inside / one[_AREA],
        centre_distance=np.log(np.sqrt((step**2).sum() / one[_AREA]) + _TINY),
        small_compactness=np.log(one[_AREA] / (one[_PRODUCTS::4].sum() + _TINY)),
        large_compactness=np.log(other[_AREA] / (other[_PRODUCTS::4].sum() + _TINY)),
        small_open=np.log1p(one[_OPEN] / np.sqrt(one[_AREA])),
        large_open=np.log1p(other[_OPEN] / np.sqrt(other[_AREA])),
        small_confidence=one[_CONFIDENCE],
        large_confidence=other[_CONFIDENCE],
        repeats=np.log(bodies.repeats[only]) if only >= 0 else 0.0,
        flat_share=flat / border,
        bodies=np.log(bodies.count),
        mean_affinity=np.log(fields.mean_affinity),
    )


@njit(cache=True)
def _sums_of_cut(part: SegmentFields, small: BoolArray) -> tuple[float, float, float]:
    """The length of the cut, of the contacts in it, and of what runs between coplanar faces."""
    border = contact = flat = 0.0
    for e in range(len(part.edges)):
        a, b = part.edges[e, 0], part.edges[e, 1]
        if small[a] != small[b]:
            border += part.length[e]
            flat += part.length[e] * part.flat[e]
            if part.body[a] != part.body[b]:
                contact += part.length[e]
    return border, contact, flat


@njit(cache=True)
def _sums_of_sides(part: SegmentFields, small: BoolArray) -> FloatArray:
    """(2, 15) of the small side and of the other: area, open border, mean confidence, centroid, and covariance."""
    sums = np.zeros((2, _PRODUCTS + 9))
    for i in range(len(small)):
        row = 0 if small[i] else 1
        v = part.volume[i]
        sums[row, _AREA] += v
        sums[row, _OPEN] += part.open_border[i]
        sums[row, _CONFIDENCE] += v * part.confidence[i]
        for k in range(3):
            sums[row, _CENTRE + k] += v * part.points[i, k]
    for row in range(2):
        for k in range(_CONFIDENCE, _PRODUCTS):
            sums[row, k] /= sums[row, _AREA]
    for i in range(len(small)):
        row = 0 if small[i] else 1
        share = part.volume[i] / sums[row, _AREA]
        for k in range(3):
            for m in range(3):
                away = (part.points[i, k] - sums[row, _CENTRE + k]) * (part.points[i, m] - sums[row, _CENTRE + m])
                sums[row, _PRODUCTS + 3 * k + m] += share * away
    return sums


@njit(cache=True)
def _pieces(part: SegmentFields, small: BoolArray) -> tuple[int, int, float]:
    """The numbers of pieces with a part in the small side and in the other, and the area of those with both."""
    area = np.zeros((2, part.piece.max() + 1))
    for i in range(len(small)):
        area[0 if small[i] else 1, part.piece[i]] += part.volume[i]
    few = many = 0
    divided = 0.0
    for p in range(area.shape[1]):
        few += area[0, p] > 0.0
        many += area[1, p] > 0.0
        if area[0, p] > 0.0 and area[1, p] > 0.0:
            divided += area[0, p] + area[1, p]
    return few, many, divided


@njit(cache=True)
def _bodies(part: SegmentFields, small: BoolArray, area: FloatArray) -> tuple[float, float, float, int]:
    """What the sides have of the bodies with areas (B,).

    Returns
    -------
    The areas of whole bodies in the small side and in the other; the area of the bodies that the small side has a part
    of; and the one body that is the small side, -1 if it is not one whole body.
    """
    inside = np.zeros((2, len(area)))
    for i in range(len(small)):
        inside[0 if small[i] else 1, part.body[i]] += part.volume[i]
    whole = np.zeros(2)
    touched = 0.0
    bodies, only = 0, -1
    for b in range(len(area)):
        for row in range(2):
            if inside[row, b] >= _WHOLE * area[b]:
                whole[row] += inside[row, b]
        if inside[0, b] > 0.0:
            touched += area[b]
            bodies += 1
            only = b
    if bodies > 1 or inside[0, only] < _WHOLE * area[only]:
        only = -1
    return whole[0], whole[1], touched, only


@njit(cache=True)
def _area_in_box(part: SegmentFields, small: BoolArray, other: FloatArray) -> float:
    """The area of the small side inside the box around the other side, along the principal axes of that side."""
    axes = np.linalg.eigh(other[_PRODUCTS:].reshape(3, 3))[1]
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    along = np.zeros((len(small), 3))
    for i in range(len(small)):
        for k in range(3):
            for m in range(3):
                along[i, k] += (part.points[i, m] - other[_CENTRE + m]) * axes[m, k]
            if not small[i]:
                low[k] = min(low[k], along[i, k])
                high[k] = max(high[k], along[i, k])
    inside = 0.0
    for i in range(len(small)):
        if small[i] and (along[i] >= low).all() and (along[i] <= high).all():
            inside += part.volume[i]
    return inside
