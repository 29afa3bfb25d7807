"""Plates with holes, as CAD programs write them."""

import manifold3d
import numpy as np

from segcore.mesh import Mesh

CENTRE, FAR = (0.1, 0.2), (-0.6, -0.3)  # of holes


def plate() -> manifold3d.Manifold:
    """A plate 2 by 1.4 and 0.2 thick, around the origin."""
    return manifold3d.Manifold.cube((2.0, 1.4, 0.2), center=True)


def rod(radius: float, sides: int, at: tuple[float, float] = CENTRE, low: float = -1.0) -> manifold3d.Manifold:
    """A prism along z, 2 long, from a height ``low``."""
    return manifold3d.Manifold.cylinder(2.0, radius, radius, sides).translate((*at, low))


def mesh_of(solid: manifold3d.Manifold) -> Mesh:
    mesh = solid.to_mesh()
    return Mesh(np.array(mesh.vert_properties[:, :3], np.float64), np.array(mesh.tri_verts, np.int32))
