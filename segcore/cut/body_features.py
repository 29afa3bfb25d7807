"""Features of what cuts do to the bodies of a segment, and of how their sides stand to each other."""

from typing import NamedTuple

import numpy as np

from segcore.arrays import FloatArray
from segcore.cut.cut_sums import CutSums, SideSums
from segcore.cut.fields import ClusterFields

_TINY = 1e-12  # keeps logarithms and quotients finite; far below all values of surfaces of unit size
_LEAST_CONTACT = 1e-4  # of the square root of an area: a contact of this length counts as none; set by hand


class BodyFeatures(NamedTuple):
    """Features of N cuts beside those of their shape. ``small`` is the side of less area."""

    contact_share: FloatArray  # share of the length of the cut that is contact between bodies
    contact_over_small: FloatArray  # logarithm of the length of the contact over sqrt(area of the small side)
    small_pieces: FloatArray  # logarithm of one more than the number of pieces that have a part in the small side
    large_pieces: FloatArray
    divided: FloatArray  # share of the area of the segment in pieces that the cut divides
    small_whole: FloatArray  # share of the area of the small side in whole bodies
    large_whole: FloatArray
    small_of_body: FloatArray  # logarithm of the share of the small side in the bodies that it has a part of
    small_inside: FloatArray  # share of the area of the small side inside the box around the large side
    centre_distance: FloatArray  # logarithm of the distance of the centroids over sqrt(area of the small side)
    small_compactness: FloatArray  # logarithm of the area over the total variance of the points
    large_compactness: FloatArray
    small_open: FloatArray  # logarithm of one more than the length of open borders over sqrt(area)
    large_open: FloatArray
    small_confidence: FloatArray  # share of the rays of the thickness that met the other side from inside
    large_confidence: FloatArray
    repeats: FloatArray  # logarithm of the number of bodies like the small side, if that is one whole body; 0 otherwise
    flat_share: FloatArray  # share of the length of the cut that runs between coplanar faces
    bodies: float  # logarithm of the number of bodies of the whole surface
    mean_affinity: float  # logarithm of the mean affinity inside the bodies of the whole surface


def body_features(fields: ClusterFields, sides: SideSums, borders: CutSums) -> BodyFeatures:
    """The features of cuts with the sums ``sides`` and ``borders``."""
    small, large = sides.area.T
    root = np.sqrt(sides.area)
    distance = np.sqrt(((sides.centre[:, 0] - sides.centre[:, 1]) ** 2).sum(axis=1))
    compactness = np.log(sides.area / (sides.variance.sum(axis=2) + _TINY))
    openness = np.log1p(sides.open_border / root)
    repeats = np.where(borders.only < 0, 1, fields.bodies.repeats[borders.only])
    return BodyFeatures(
        contact_share=borders.contact / borders.border,
        contact_over_small=np.log(borders.contact / root[:, 0] + _LEAST_CONTACT),
        small_pieces=np.log1p(sides.pieces[:, 0]),
        large_pieces=np.log1p(sides.pieces[:, 1]),
        divided=borders.divided / (small + large),
        small_whole=sides.whole[:, 0] / small,
        large_whole=sides.whole[:, 1] / large,
        small_of_body=np.log(small / borders.touched),
        small_inside=borders.boxed / small,
        centre_distance=np.log(distance / root[:, 0] + _TINY),
        small_compactness=compactness[:, 0],
        large_compactness=compactness[:, 1],
        small_open=openness[:, 0],
        large_open=openness[:, 1],
        small_confidence=sides.confidence[:, 0],
        large_confidence=sides.confidence[:, 1],
        repeats=np.log(repeats),
        flat_share=borders.flat / borders.border,
        bodies=float(np.log(fields.bodies.count)),
        mean_affinity=float(np.log(fields.mean_affinity)),
    )
