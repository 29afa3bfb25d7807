"""Mass, centre of mass and inertia of solids of one density."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from segcore.arrays import FloatArray, IntArray

_LEAST_VOLUME = 1e-12  # of the cube of the extent: less is rounding error


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


def mass_properties(solids: Sequence[Solid], density: float) -> MassProperties | None:
    """Return the sum over solids; None if they enclose no volume.

    Parameters
    ----------
    density : in kg / m^3.
    """
    from trimesh import triangles

    corners = [solid.vertices[solid.faces] for solid in solids]
    if not corners:
        return None
    joined = np.concatenate(corners)
    origin = joined.mean(axis=(0, 1))
    found = triangles.mass_properties(joined - origin, density=density)
    extent = float(np.ptp(joined.reshape(-1, 3), axis=0).max())
    if not found.volume > _LEAST_VOLUME * extent**3:
        return None
    return MassProperties(float(found.volume), float(found.mass), origin + found.center_mass, np.array(found.inertia))
