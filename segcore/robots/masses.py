"""Mass, centre of mass and inertia of solids of one density."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from segcore.arrays import FloatArray, IntArray

_LEAST_VOLUME = 1e-12  # of the cube of the extent: less is rounding error
_LEAST_SPREAD = 1e-12  # of second moments, the least over the largest


@dataclass(frozen=True, slots=True, eq=False)
class Solid:
    """A closed surface; lengths in metres."""

    vertices: FloatArray  # (V, 3)
    faces: IntArray  # (F, 3)


@dataclass(frozen=True, slots=True, eq=False)
class MassProperties:
    """What a rigid body is to a simulator."""

    volume: float  # m^3
    mass: float  # kg
    centre: FloatArray  # (3,) of mass, in metres
    inertia: FloatArray  # (3, 3) about the centre, in kg m^2, along the axes of the coordinates


def encloses_space(faces: IntArray) -> bool:
    """Whether faces run through every edge as often in one direction as in the other.

    Then the integrals over their tetrahedra are those over the enclosed space, even if edges have more than two faces.
    """
    ends = faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2).astype(np.int64)
    count = int(faces.max(initial=0)) + 1
    forward, backward = (np.sort(ends[:, k] * count + ends[:, 1 - k]) for k in (0, 1))
    return bool((forward == backward).all())


def mass_properties(solids: Sequence[Solid], density: float) -> MassProperties | None:
    """Return the sum over solids; None if they enclose no volume, or space with both signs.

    The integrals over the tetrahedra (0, a, b, c) of the faces, with d = det(a, b, c) and s = a + b + c: the volume
    d / 6, the first moment d s / 24, and the second moments d (a a^T + b b^T + c c^T + s s^T) / 120.

    Parameters
    ----------
    density : in kg / m^3.

    References
    ----------
    J. Blow, A. J. Binstock, How to find the inertia tensor (or other mass properties) of a 3D solid body represented by
    a triangle mesh, 2004.
    """
    if not solids:
        return None
    corners = np.concatenate([solid.vertices[solid.faces] for solid in solids])
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    extent = float((high - low).max())
    corners = (corners - 0.5 * (low + high)) / extent if extent > 0 else np.zeros_like(corners)
    determinant = np.einsum("fj,fj->f", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))
    volume = float(determinant.sum()) / 6
    if not volume > _LEAST_VOLUME:
        return None
    total = corners.sum(axis=1)
    centre = determinant @ total / (24 * volume)
    moments = np.einsum("f,fki,fkj->ij", determinant, corners, corners)
    moments = (moments + np.einsum("f,fi,fj->ij", determinant, total, total)) / 120 - volume * np.outer(centre, centre)
    spread = np.linalg.eigvalsh(moments)
    if not spread[0] > _LEAST_SPREAD * spread[2]:
        return None  # a surface that crosses itself, so that there are parts of the space with opposite signs
    inertia = np.trace(moments) * np.eye(3) - moments
    size = volume * extent**3
    return MassProperties(size, density * size, 0.5 * (low + high) + extent * centre, density * extent**5 * inertia)
