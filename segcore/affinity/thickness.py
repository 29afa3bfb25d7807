"""The shape diameter function: how thick the body is behind every patch of a surface.

Shapira, Shamir and Cohen-Or, Consistent mesh partitioning and skeletonisation using the shape diameter function, The
Visual Computer 24, 2008: a cone of rays goes inward and the typical distance to the other side is taken. The rays of a
patch start all over it, each face lending its normal, so that a few dozen rays a patch see what thousands from single
faces would.
"""

from dataclasses import dataclass

import numpy as np
from numba import njit

from segcore.affinity.frames import tangent_frames
from segcore.affinity.patches import Patches
from segcore.affinity.rays import RayCaster
from segcore.arrays import FloatArray, IntArray, at_least
from segcore.clean.surface import Surface

RAYS = 24  # of every patch
_HALF_ANGLE = np.deg2rad(60.0)
_START = 1e-4  # how far below the surface rays start, in units of the square root of the total area
_SMALLEST_FACE = 1e-9  # least area of a face that is sampled, in mean areas
_GOLDEN = np.pi * (3.0 - np.sqrt(5.0))


@dataclass(frozen=True, slots=True, eq=False)
class Thickness:
    """The shape diameter of every patch, before any smoothing."""

    logarithm: FloatArray  # (P,) logarithm of the shape diameter over the square root of the total area; 0 unknown
    confidence: FloatArray  # (P,) share of the rays that met the other side from within, 0 to 1


def patch_thickness(surface: Surface, patches: Patches) -> Thickness:
    """The shape diameter of patches.

    Rays spread over a cone of half-angle 60 degrees, as a Vogel disc. Of the distances to faces met from behind, those
    more than a standard deviation from the median are left out; the others are averaged with the cosine of their angle
    as weight.

    Notes
    -----
    A ray that meets nothing, or a face from its front, tells that the surface is open, turned the wrong way, or runs
    through another part: it only lowers the confidence.
    """
    size = float(np.sqrt(patches.area.sum()))
    origins, directions, cosines = _rays(surface, patches, size)
    caster = RayCaster.of(surface.vertices, surface.faces)
    distance = caster.inner_distances(origins, directions).reshape(-1, RAYS)
    value, confidence = _typical(distance, cosines.reshape(-1, RAYS))
    known = value > 0
    logarithm = np.zeros(len(value))
    logarithm[known] = np.log(value[known] / size)
    return Thickness(logarithm, confidence)


def _rays(surface: Surface, patches: Patches, size: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Origins, directions and cosines to the inward normal of the rays, ``RAYS`` for patch 0, then for patch 1, ..."""
    face, place = _sample_faces(patches.of_face, surface.areas, len(patches.area))
    corners = surface.vertices[surface.faces[face]]
    inward = -surface.normals[face]
    flat = ~inward.any(axis=1)
    inward[flat] = -np.repeat(patches.normal, RAYS, axis=0)[flat]
    # A low-discrepancy pair for the place inside the triangle: the fraction left over by the choice of the face, and
    # the golden ratio sequence.
    number = np.tile(np.arange(RAYS), len(patches.area))
    root = np.sqrt(place)
    other = np.modf(0.5 + number * 0.6180339887498949)[0]
    weights = np.stack([1.0 - root, root * (1.0 - other), root * other], axis=1)
    origins = np.einsum("ij,ijk->ik", weights, corners) + _START * size * inward
    # The order of the disc is not that of the places on the patch: otherwise one side would look one way only.
    spoke = (number * 7) % RAYS
    sine = np.sin(_HALF_ANGLE) * np.sqrt((spoke + 0.5) / RAYS)
    cosine = np.sqrt(1.0 - sine**2)
    turn = _GOLDEN * spoke
    u, v = tangent_frames(inward)
    directions = (sine * np.cos(turn))[:, None] * u + (sine * np.sin(turn))[:, None] * v + cosine[:, None] * inward
    return origins, directions, cosine


def _sample_faces(of_face: IntArray, areas: FloatArray, count: int) -> tuple[IntArray, FloatArray]:
    """Faces at ``RAYS`` equal steps of area through every patch, and where within the face the step falls, 0 to 1."""
    order = np.argsort(of_face, kind="stable").astype(np.int32)
    sizes = at_least(areas, _SMALLEST_FACE)[order]
    end = np.cumsum(sizes)
    last = np.cumsum(np.bincount(of_face, minlength=count)) - 1
    high = end[last]
    low = np.concatenate([[0.0], high[:-1]])
    steps = (np.arange(RAYS) + 0.5) / RAYS
    wanted = (low[:, None] + (high - low)[:, None] * steps).ravel()
    found = np.minimum(np.searchsorted(end, wanted), len(order) - 1)
    place = np.clip((wanted - (end[found] - sizes[found])) / sizes[found], 0.0, 1.0)
    return order[found], place


@njit(cache=True)
def _typical(distances, cosines):  # type: ignore[no-untyped-def]
    """(P,) the weighted mean of the distances near their median, 0 where there are none, and (P,) the share of hits."""
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
        spread = np.std(hit[:hits]) + 1e-12 * middle
        total, weight = 0.0, 0.0
        for j in range(rays):
            if abs(distances[i, j] - middle) <= spread:
                total += cosines[i, j] * distances[i, j]
                weight += cosines[i, j]
        value[i] = total / weight if weight > 0.0 else middle
    return value, confidence


def smooth_logarithm(thickness: Thickness, patches: Patches, radius: float) -> FloatArray:
    """(P,) logarithm of the shape diameter smoothed over a radius; unknown patches take what is known around them."""
    mass = patches.area * np.maximum(thickness.confidence, 1e-6)
    return patches.smoothed(thickness.logarithm, radius, mass)
