"""The shape diameter function: how thick the body is behind every patch of a surface.

Shapira, Shamir and Cohen-Or, Consistent mesh partitioning and skeletonisation using the shape diameter function, The
Visual Computer 24, 2008: the typical length of a cone of rays that go inward to the other side. The rays of a patch
start at places spread over its faces, around the normals of these faces, so that a few dozen rays per patch suffice.
"""

from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np

from segcore.affinity.frames import tangent_vectors
from segcore.affinity.patches import Patches
from segcore.affinity.rays import VISITS_AT_FIRST, RayCaster, cast
from segcore.array_kernels import members_by_group
from segcore.arrays import FloatArray, IntArray, LongArray, at_least
from segcore.clean.surface import Surface
from segcore.graphs.mesh_graph import Opposites
from segcore.jit.decorators import inner_kernel, kernel

RAYS = 24  # per patch; with 8 or 12 1-Rand is 0.000 to 0.003 worse, see "What helped" in bench/RESULTS.md
_MANY_PATCHES = 10_000  # five times as many as of a surface with few components; set by hand
_HALF_ANGLE = np.deg2rad(60.0)  # of the cone, as in the paper of Shapira et al.
_START = 1e-4  # distance below the surface at which rays start, in sqrt(total area); set by hand
_SMALLEST_FACE = 1e-9  # least area of a sampled face in mean areas: keeps the steps of area positive
_LEAST_CONFIDENCE = 1e-6  # in the mass of a patch: keeps the system of the smoothing regular
_EQUAL = 1e-12  # relative tolerance around the median: keeps all distances of a patch whose distances are equal
_ALONG_NORMAL = 0.95  # least cosine of the angle between a ray that links opposite faces and the normal; decision 29
_OPPOSITE = 0.9  # least cosine of the angle between the normals of opposite faces, one of them reversed; set by hand
_GOLDEN_RATIO = 0.6180339887498949
_GOLDEN_ANGLE = np.pi * (3.0 - np.sqrt(5.0))
_STRIDE = 7  # between the places of a patch and the spokes of the disc; coprime to RAYS


@dataclass(frozen=True, slots=True, eq=False)
class Thickness:
    """The shape diameter of every patch, not smoothed."""

    logarithm: FloatArray  # (P,) logarithm of the shape diameter over sqrt(total area); 0 if unknown
    confidence: FloatArray  # (P,) share of the rays that met the other side from inside, 0 to 1
    opposites: Opposites  # pairs of faces


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
    value, confidence = np.zeros((2, len(patches.area)))
    rays = _rays(surface, patches, chosen, size)
    value[chosen], confidence[chosen] = _typical(rays.distance, _disc()[:, 2])
    known = value > 0
    logarithm = np.zeros(len(value))
    logarithm[known] = np.log(value[known] / size)
    return Thickness(logarithm, confidence, _opposites(rays, surface.normals, patches.area[chosen]))


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


class _Samples(NamedTuple):
    """The faces of some patches, and where their rays start."""

    face: IntArray  # (F,) the faces, by patch
    first: LongArray  # (P + 1,) patch p has the faces face[first[p]:first[p + 1]]
    chosen: LongArray  # (K,) the patches that rays are cast from
    normal: FloatArray  # (P, 3) normals that slivers take
    start: float  # distance below the surface at which rays start


class _Faces(NamedTuple):
    """The faces of a surface."""

    corner: IntArray  # (F, 3)
    vertices: FloatArray  # (V, 3)
    normal: FloatArray  # (F, 3), 0 for slivers
    area: FloatArray  # (F,) > 0


class _Rays(NamedTuple):
    """What the rays of K patches met."""

    distance: FloatArray  # (K, RAYS), infinity for a ray that does not leave the body
    start: IntArray  # (K, RAYS) the face at which a ray starts
    met: IntArray  # (K, RAYS) the face that it meets from inside; -1 if there is none


@cache
def _disc() -> FloatArray:
    """(RAYS, 4) for every ray: its components along the frame (u, v, normal), and its place in a triangle, 0 to 1."""
    number = np.arange(RAYS)
    # The spokes of the disc follow another order than the places; otherwise all rays from one side of the patch would
    # have similar directions.
    spoke = (number * _STRIDE) % RAYS
    sine = np.sin(_HALF_ANGLE) * np.sqrt((spoke + 0.5) / RAYS)
    turn = _GOLDEN_ANGLE * spoke
    place = np.modf(0.5 + number * _GOLDEN_RATIO)[0]
    return np.stack([sine * np.cos(turn), sine * np.sin(turn), np.sqrt(1.0 - sine**2), place], axis=1)


def _opposites(rays: _Rays, normals: FloatArray, area: FloatArray) -> Opposites:
    """The faces that face away from each other at both ends of rays that run nearly along normals.

    Parameters
    ----------
    normals : (F, 3) of the faces.
    area : (K,) of the patches.
    """
    cosine = _disc()[:, 2]
    steep = np.flatnonzero(cosine >= _ALONG_NORMAL)
    patch, number = np.nonzero(rays.met[:, steep] >= 0)
    ray = steep[number]
    faces = np.stack([rays.start[patch, ray], rays.met[patch, ray]], axis=1)
    facing = np.einsum("ij,ij->i", normals[faces[:, 0]], normals[faces[:, 1]]) <= -_OPPOSITE
    distance = rays.distance[patch, ray] * cosine[ray]
    return Opposites(faces[facing], distance[facing], area[patch[facing]] / len(steep))


def _rays(surface: Surface, patches: Patches, chosen: LongArray, size: float) -> _Rays:
    """Cast the rays of some patches."""
    shape = len(chosen), RAYS
    rays = _Rays(np.empty(shape), np.empty(shape, dtype=np.int32), np.empty(shape, dtype=np.int32))
    if len(chosen) == 0:
        return rays
    members, first = members_by_group(patches.of_face, len(patches.area))
    faces = _Faces(surface.faces, surface.vertices, surface.normals, at_least(surface.areas, _SMALLEST_FACE))
    samples = _Samples(members, first, chosen, patches.normal, _START * size)
    _cast(RayCaster.of(surface.vertices, surface.faces), faces, samples, _disc(), rays)
    return rays


@kernel
def _cast(caster: RayCaster, faces: _Faces, samples: _Samples, disc: FloatArray, made: _Rays) -> None:
    """Write ``_rays``: the rays of a patch start at equal steps of area through its faces.

    The place inside the triangle is a low-discrepancy pair: the fraction that is left from the choice of the face, and
    the golden ratio sequence.
    """
    rays = len(disc)
    origin, direction, inward = np.empty((rays, 3)), np.empty((rays, 3)), np.empty(3)
    left = VISITS_AT_FIRST
    for row in range(len(samples.chosen)):
        patch = samples.chosen[row]
        place, last = samples.first[patch], samples.first[patch + 1] - 1
        total = 0.0
        for k in range(place, last + 1):
            total += faces.area[samples.face[k]]
        passed = 0.0  # area of the faces before the one at ``place``
        for j in range(rays):
            wanted = (j + 0.5) / rays * total
            while place < last and passed + faces.area[samples.face[place]] < wanted:
                passed += faces.area[samples.face[place]]
                place += 1
            f = samples.face[place]
            made.start[row, j] = f
            root = np.sqrt(min(max((wanted - passed) / faces.area[f], 0.0), 1.0))
            is_sliver = faces.normal[f, 0] == 0.0 and faces.normal[f, 1] == 0.0 and faces.normal[f, 2] == 0.0
            a, b, c = faces.corner[f, 0], faces.corner[f, 1], faces.corner[f, 2]
            for i in range(3):
                inward[i] = -samples.normal[patch, i] if is_sliver else -faces.normal[f, i]
                origin[j, i] = (
                    (1.0 - root) * faces.vertices[a, i]
                    + root * (1.0 - disc[j, 3]) * faces.vertices[b, i]
                    + root * disc[j, 3] * faces.vertices[c, i]
                    + samples.start * inward[i]
                )
            u, v = tangent_vectors(inward[0], inward[1], inward[2])
            for i in range(3):
                direction[j, i] = disc[j, 0] * u[i] + disc[j, 1] * v[i] + disc[j, 2] * inward[i]
        left = cast(caster, origin, direction, made.distance[row], made.met[row], left)


@kernel
def _typical(distances: FloatArray, cosines: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(P,) the weighted mean of the distances near their median, 0 if there are none, and (P,) the share of hits.

    Parameters
    ----------
    distances : (P, RAYS), infinity for a ray without a hit.
    cosines : (RAYS,)
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
        middle = _median(hit, hits)
        spread = _deviation(hit, hits) + _EQUAL * middle
        total, weight = 0.0, 0.0
        for j in range(rays):
            if abs(distances[i, j] - middle) <= spread:
                total += cosines[j] * distances[i, j]
                weight += cosines[j]
        value[i] = total / weight if weight > 0.0 else middle
    return value, confidence


@inner_kernel
def _median(values: FloatArray, count: int) -> float:
    """The median of the first numbers of an array, which are sorted in place."""
    for i in range(1, count):
        value, place = values[i], i
        while place > 0 and values[place - 1] > value:
            values[place] = values[place - 1]
            place -= 1
        values[place] = value
    return 0.5 * (values[(count - 1) // 2] + values[count // 2])


@inner_kernel
def _deviation(values: FloatArray, count: int) -> float:
    """The standard deviation of the first numbers of an array."""
    mean = 0.0
    for i in range(count):
        mean += values[i] / count
    square = 0.0
    for i in range(count):
        square += (values[i] - mean) ** 2
    return np.sqrt(square / count)
