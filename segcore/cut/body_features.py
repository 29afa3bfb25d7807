"""Features of what cuts do to the bodies of a segment, and of how their sides stand to each other."""

from typing import NamedTuple

import numpy as np

from segcore.cut.cut_sums import CutSums, SideSums
from segcore.cut.fields import Whole
from segcore.jit.decorators import inner_kernel

_TINY = 1e-12  # keeps logarithms and quotients finite; far below all values of surfaces of unit size
_LEAST_CONTACT = 1e-4  # of the square root of an area: a contact of this length counts as none; set by hand


class BodyFeatures(NamedTuple):
    """Features of a cut beside those of their shape. ``small`` is the side of less area."""

    contact_share: float  # share of the length of the cut that is contact between bodies
    contact_over_small: float  # logarithm of the length of the contact over sqrt(area of the small side)
    contact_concavity: float  # mean over the contact of the concavity of ``Links``; 0 if there is none
    small_pieces: float  # logarithm of one more than the number of pieces that have a part in the small side
    large_pieces: float
    divided: float  # share of the area of the segment in pieces that the cut divides
    small_whole: float  # share of the area of the small side in whole bodies
    large_whole: float
    small_of_body: float  # logarithm of the share of the small side in the bodies that it has a part of
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


@inner_kernel
def body_features(sides: SideSums, cuts: CutSums, n: int, whole: Whole) -> BodyFeatures:
    """The features of the cut ``n`` of those with the sums ``sides`` and ``cuts``."""
    small, large = sides.area[n]
    root, border = np.sqrt(small), cuts.border[n]
    distance = 0.0
    for k in range(3):
        distance += (sides.centre[n, 0, k] - sides.centre[n, 1, k]) ** 2
    only = cuts.only[n]
    return BodyFeatures(
        cuts.contact[n] / border,
        np.log(cuts.contact[n] / root + _LEAST_CONTACT),
        cuts.concavity[n] / cuts.contact[n] if cuts.contact[n] > 0.0 else 0.0,
        np.log1p(sides.pieces[n, 0]),
        np.log1p(sides.pieces[n, 1]),
        cuts.divided[n] / (small + large),
        sides.whole[n, 0] / small,
        sides.whole[n, 1] / large,
        np.log(small / cuts.touched[n]),
        cuts.boxed[n] / small,
        np.log(np.sqrt(distance) / root + _TINY),
        np.log(small / (sides.variance[n, 0].sum() + _TINY)),
        np.log(large / (sides.variance[n, 1].sum() + _TINY)),
        np.log1p(sides.open_border[n, 0] / root),
        np.log1p(sides.open_border[n, 1] / np.sqrt(large)),
        sides.confidence[n, 0],
        sides.confidence[n, 1],
        np.log(float(whole.repeats[only])) if only >= 0 else 0.0,
        cuts.flat[n] / border,
        whole.log_bodies,
        whole.log_affinity,
    )
