"""Solids and their Boolean operations by manifold3d, an optional package."""

from __future__ import annotations

from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np

from segcore.arrays import FloatArray, IntArray, plane_axes
from segcore.errors import MissingPackage

if TYPE_CHECKING:
    from manifold3d import CrossSection, Manifold

_SIDES = 64  # of the polygon of a connector, set by hand: at a diameter of 10 mm it differs from a circle by 0.006 mm
_CONTAINED = 1e-6  # of its volume, by which a solid may stick out; set by hand


def library() -> ModuleType:
    """Return manifold3d.

    Raises
    ------
    MissingPackage
        If it is not installed.
    """
    try:
        import manifold3d
    except ImportError:
        raise MissingPackage(
            "Files with connectors need the package manifold3d: run pip install 'cleave-mesh[print]'."
        ) from None
    return manifold3d


def solid_of(vertices: FloatArray, faces: IntArray) -> Manifold | None:
    """Return closed faces as a solid; None if they are not the surface of one."""
    kernel = library()
    arrays = np.array(vertices, order="C"), np.array(faces, dtype=np.uint64, order="C")  # it takes no read-only ones
    solid = kernel.Manifold(kernel.Mesh64(*arrays))
    is_sound = solid.status() == kernel.Error.NoError and solid.volume() > 0
    return solid if is_sound else None


def surface_of(solid: Manifold) -> tuple[FloatArray, IntArray]:
    """Return the vertices (V, 3) and the faces (F, 3) of a solid."""
    mesh = solid.to_mesh64()
    return np.array(mesh.vert_properties)[:, :3], np.array(mesh.tri_verts, dtype=np.int32)


def cylinder(centre: FloatArray, direction: FloatArray, radius: float, begin: float, end: float) -> Manifold:
    """Return a cylinder, a prism with 64 sides, from ``begin`` to ``end`` along the unit vector ``direction``."""
    upright = library().Manifold.cylinder(end - begin, radius, radius, _SIDES).translate([0.0, 0.0, begin])
    axes = np.column_stack([*plane_axes(direction), direction])
    return upright.transform(np.column_stack([axes, centre]))


def hole_radius(radius: float, clearance: float) -> float:
    """Return the radius of a hole whose flat sides are half the clearance from those of a cylinder."""
    return radius + 0.5 * clearance / float(np.cos(np.pi / _SIDES))


def contains(solid: Manifold, other: Manifold) -> bool:
    """Whether a solid contains another one."""
    return bool((other - solid).volume() <= _CONTAINED * other.volume())


def region(triangles: FloatArray) -> CrossSection:
    """Return the union of plane triangles (N, 3, 2) of any orientation."""
    kernel = library()
    one, other = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    turned = one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0] < 0
    oriented = np.where(turned[:, None, None], triangles[:, ::-1], triangles)
    return kernel.CrossSection(list(oriented), kernel.FillRule.Positive)
