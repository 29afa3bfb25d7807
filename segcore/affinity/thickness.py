"""The shape diameter function: how thick the body is behind every patch of a surface.

Shapira, Shamir and Cohen-Or, Consistent mesh partitioning and skeletonisation using the shape diameter function, The
Visual Computer 24, 2008: the typical length of a cone of rays that go inward to the other side. The rays of a patch
start at places spread over its faces, around the normals of these faces, so that a few dozen rays per patch suffice.
"""

from dataclasses import dataclass

import numpy as np
from numba import njit

from segcore.affinity.frames import tangent_frames
from segcore.affinity.patches import Patches
from segcore.affinity.rays import RayCaster
from segcore.arrays import FloatArray, IntArray, LongArray, at_least
from segcore.clean.surface import Surface

RAYS = 24  # per patch; with 8 or 12 1-Rand is 0.000 to 0.003 worse, see "What helped" in bench/RESULTS.md
_MANY_PATCHES = 10_000  # five times as many as of a surface with few components; set by hand
_HALF_ANGLE = np.deg2rad(60.0)  # of the cone, as in the paper of Shapira et al.
_START = 1e-4  # distance below the surface at which rays start, in sqrt(total area); set by hand
_SMALLEST_FACE = 1e-9  # least area of a sampled face in mean areas: keeps the steps of area positive
_LEAST_CONFIDENCE = 1e-6  # in the mass of a patch: keeps the system of the smoothing regular
_EQUAL = 1e-12  # relative tolerance around the median: keeps all distances of a patch whose distances are equal
_GOLDEN_RATIO = 0.6180339887498949
_GOLDEN_ANGLE = np.pi * (3.0 - np.sqrt(5.0))
_STRIDE = 7  # between the places of a patch and the spokes of the disc; coprime to RAYS


@dataclass(frozen=True, slots=True, eq=False)
class Thickness:
    """The shape diameter of every patch, not smoothed."""

    logarithm: FloatArray  # (P,) logarithm of the shape diameter over sqrt(total area); 0 if unknown
    confidence: FloatArray  # (P,) share of the rays that met the other side from inside, 0 to 1


def patch_thickness(surface: Surface, patches: Patches) -> Thickness:
    """The shape diameter of patches.

    Rays spread over a cone of half-angle 60 degrees, as a Vogel disc. Of the distances to faces met from behind, those
    more than a standard deviation from the median are left out; the others are averaged with the cosine of their angle
    as weight.

    Notes
    -----
    A ray that meets nothing, or the front of a face, shows that the surface is open, inside out or runs through another
    part. Such rays only lower the confidence.
    """
    size = float(np.sqrt(patches.area.sum()))
    chosen = _measurable(patches)
    if len(chosen) == 0:
        return Thickness(*np.zeros((2, len(patches.area))))
    rays = _rays(surface, patches, chosen, size)
    distance = RayCaster.of(surface.vertices, surface.faces).inner_distances(rays.origins, rays.directions)
    value, confidence = np.zeros((2, len(patches.area)))
    value[chosen], confidence[chosen] = _typical(distance.reshape(-1, RAYS), rays.cosines.reshape(-1, RAYS))
    known = value > 0
    logarithm = np.zeros(len(value))
    logarithm[known] = np.log(value[known] / size)
    return Thickness(logarithm, confidence)


def smooth_logarithm(thickness: Thickness, patches: Patches, radius: float) -> FloatArray:
    """(P,) logarithm of the shape diameter smoothed over a radius; unknown patches take the values around them."""
    mass = patches.area * np.maximum(thickness.confidence, _LEAST_CONFIDENCE)
    return patches.smoothed(thickness.logarithm, radius, mass)


def _measurable(patches: Patches) -> LongArray:
    """The patches that rays are cast from: all, or of very many those of four faces or more.

    There are many patches only if there are many components, as each has one at least, and a component of fewer than
    four faces encloses nothing.
    """
    if len(patches.area) <= _MANY_PATCHES:
        return np.arange(len(patches.area))
    return np.flatnonzero(np.bincount(patches.of_face, minlength=len(patches.area)) >= 4)


@dataclass(frozen=True, slots=True, eq=False)
class _Rays:
    """The rays of some patches: ``RAYS`` of the first, then of the second, ..."""

    origins: FloatArray  # (N, 3)
    directions: FloatArray  # (N, 3) unit vectors
    cosines: FloatArray  # (N,) of the angle to the inward normal


def _rays(surface: Surface, patches: Patches, chosen: LongArray, size: float) -> _Rays:
    face, place = _sample_faces(patches.of_face, surface.areas, len(patches.area), chosen)
    corners = surface.vertices[surface.faces[face]]
    inward = -surface.normals[face]
    is_sliver = ~inward.any(axis=1)
    inward[is_sliver] = -np.repeat(patches.normal[chosen], RAYS, axis=0)[is_sliver]
    # The place inside the triangle is a low-discrepancy pair: the fraction that is left from the choice of the face,
    # and the golden ratio sequence.
    number = np.tile(np.arange(RAYS), len(chosen))
    root = np.sqrt(place)
    other = np.modf(0.5 + number * _GOLDEN_RATIO)[0]
    weights = np.stack([1.0 - root, root * (1.0 - other), root * other], axis=1)
    origins = np.einsum("ij,ijk->ik", weights, corners) + _START * size * inward
    # The spokes of the disc follow another order than the places; otherwise all rays from one side of the patch would
    # have similar directions.
    spoke = (number * _STRIDE) % RAYS
    sine = np.sin(_HALF_ANGLE) * np.sqrt((spoke + 0.5) / RAYS)
    cosine = np.sqrt(1.0 - sine**2)
    turn = _GOLDEN_ANGLE * spoke
    u, v = tangent_frames(inward)
    directions = (sine * np.cos(turn))[:, None] * u + (sine * np.sin(turn))[:, None] * v + cosine[:, None] * inward
    return _Rays(origins, directions, cosine)


def _sample_faces(of_face: IntArray, areas: FloatArray, count: int, chosen: LongArray) -> tuple[IntArray, FloatArray]:
    """Faces at ``RAYS`` equal steps of area through some patches, and the position of the step in the face, 0 to 1."""
    order = np.argsort(of_face, kind="stable").astype(np.int32)
    sizes = at_least(areas, _SMALLEST_FACE)[order]
    end = np.cumsum(sizes)
    last = np.cumsum(np.bincount(of_face, minlength=count)) - 1
    high = end[last]
    low = np.concatenate([[0.0], high[:-1]])
    steps = (np.arange(RAYS) + 0.5) / RAYS
    wanted = (low[chosen, None] + (high - low)[chosen, None] * steps).ravel()
    found = np.minimum(np.searchsorted(end, wanted), len(order) - 1)
    place = np.clip((wanted - (end[found] - sizes[found])) / sizes[found], 0.0, 1.0)
    return order[found], place


@njit(cache=True, nogil=True)
def _typical(distances: FloatArray, cosines: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(P,) the weighted mean of the distances near their median, 0 if there are none, and (P,) the share of hits.

    Parameters
    ----------
    distances, cosines : (P, RAYS); the distance of a ray without a hit is infinity.
    """
    count, rays = distances.shape
    value = np.zeros(count)
    confidence = np.zeros(count)
    hit = np.empty(rays)
    for i in range(count):
        hits = 0
        for j in range(rays):
            if distances[i, j] < np.inf:
                hit[hits] = distances[i, j]
                hits += 1
        confidence[i] = hits / rays
        if hits == 0:
            continue
        middle = np.median(hit[:hits])
        spread = np.std(hit[:hits]) + _EQUAL * middle
        total, weight = 0.0, 0.0
        for j in range(rays):
            if abs(distances[i, j] - middle) <= spread:
                total += cosines[i, j] * distances[i, j]
                weight += cosines[i, j]
        value[i] = total / weight if weight > 0.0 else middle
    return value, confidence
