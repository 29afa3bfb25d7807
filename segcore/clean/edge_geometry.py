"""Length, dihedral angle and direction of the mesh edges at the dual edges of a surface."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from segcore.array_kernels import dot
from segcore.arrays import FloatArray, IntArray, LongArray, at_least
from segcore.clean.surface import Surface
from segcore.jit.decorators import inner_kernel, kernel
from segcore.threads import in_blocks

_TINY = float(np.finfo(float).tiny)
_SHORTEST = 1e-9  # least length of an edge in mean lengths: keeps weights positive and is too short to matter


@dataclass(frozen=True, slots=True, eq=False)
class EdgeGeometry:
    """Geometry of the mesh edges that the dual edges of a surface cross."""

    length: FloatArray  # (E,)
    dihedral: FloatArray  # (E,) angle between the normals in radians, 0 where flat, negative where concave
    typical_dihedral: float  # mean of the absolute dihedral angle, weighted by length; > 0

    @classmethod
    def of(cls, surface: Surface) -> "EdgeGeometry":
        """The geometry of all edges of a surface. O(E)."""
        length, dihedral = edge_lengths(surface), dihedral_angles(surface)
        typical = float(dot(length, np.abs(dihedral)) / max(length.sum(), _TINY))
        return cls(length, dihedral, max(typical, _TINY))

    @property
    def positive_length(self) -> FloatArray:
        """(E,) lengths, those of degenerate edges raised to 1e-9 of the mean."""
        return at_least(self.length, _SHORTEST)


def edge_lengths(surface: Surface) -> FloatArray:
    """(E,) length of the mesh edge that a dual edge crosses."""
    length = np.empty(len(surface.edge_vertices))
    in_blocks(_write_lengths, len(length), surface.vertices, surface.edge_vertices, length)
    return length


def dihedral_angles(surface: Surface, chosen: LongArray | None = None) -> FloatArray:
    """(N,) angle between the normals of the two faces in radians, 0 where flat, negative where concave.

    The angle is 0 if one of the faces is a sliver without a reliable normal.

    Parameters
    ----------
    chosen : N of the dual edges; None for all.
    """
    sides = surface.edge_faces if chosen is None else surface.edge_faces[chosen]
    theta = np.zeros(len(sides))
    in_blocks(_write_dihedral_angles, len(theta), surface.vertices, surface.faces, surface.normals, sides, theta)
    return theta


def across_edges(surface: Surface) -> FloatArray:
    """(E, 3) unit vectors in the surface, perpendicular to each edge.

    The plane of the surface at an edge is that of the mean normal of its two faces. The vector is 0 if that normal or
    the length of the edge is 0.
    """
    across = np.empty((len(surface.edge_faces), 3))
    in_blocks(_write_across, len(across), EdgeArrays.of(surface), across)
    return across


class EdgeArrays(NamedTuple):
    """The arrays of a surface that the direction across an edge depends on."""

    vertices: FloatArray  # (V, 3)
    normals: FloatArray  # (F, 3)
    ends: IntArray  # (E, 2) vertices
    sides: IntArray  # (E, 2) faces

    @classmethod
    def of(cls, surface: Surface) -> "EdgeArrays":
        """The arrays of a surface."""
        return cls(surface.vertices, surface.normals, surface.edge_vertices, surface.edge_faces)


@inner_kernel
def across_edge(arrays, e):  # type: ignore[no-untyped-def]
    """The three components of the unit vector in the surface that is perpendicular to an edge, see ``across_edges``."""
    p, q = arrays.vertices[arrays.ends[e, 0]], arrays.vertices[arrays.ends[e, 1]]
    n, m = arrays.normals[arrays.sides[e, 0]], arrays.normals[arrays.sides[e, 1]]
    ux, uy, uz = q[0] - p[0], q[1] - p[1], q[2] - p[2]
    nx, ny, nz = n[0] + m[0], n[1] + m[1], n[2] + m[2]
    x, y, z = uy * nz - uz * ny, uz * nx - ux * nz, ux * ny - uy * nx
    size = np.sqrt(x * x + y * y + z * z)
    return (x / size, y / size, z / size) if size > 0.0 else (0.0, 0.0, 0.0)


@kernel
def _write_across(start, end, arrays, across):  # type: ignore[no-untyped-def]
    for e in range(start, end):
        across[e, 0], across[e, 1], across[e, 2] = across_edge(arrays, e)


@kernel
def _write_lengths(start, end, vertices, ends, length):  # type: ignore[no-untyped-def]
    for e in range(start, end):
        p, q = vertices[ends[e, 0]], vertices[ends[e, 1]]
        length[e] = np.sqrt((q[0] - p[0]) ** 2 + (q[1] - p[1]) ** 2 + (q[2] - p[2]) ** 2)


@kernel
def _write_dihedral_angles(start, end, vertices, faces, normals, sides, theta):  # type: ignore[no-untyped-def]
    for e in range(start, end):
        f, g = sides[e, 0], sides[e, 1]
        n, m = normals[f], normals[g]
        x, y, z = n[1] * m[2] - n[2] * m[1], n[2] * m[0] - n[0] * m[2], n[0] * m[1] - n[1] * m[0]
        cosine = n[0] * m[0] + n[1] * m[1] + n[2] * m[2]
        if cosine == 0.0 and x == 0.0 and y == 0.0 and z == 0.0:
            continue
        angle = np.arctan2(np.sqrt(x * x + y * y + z * z), cosine)
        side = 0.0
        for k in range(3):
            for axis in range(3):
                side += (n[axis] - m[axis]) * (vertices[faces[g, k], axis] - vertices[faces[f, k], axis])
        theta[e] = -angle if side > 0.0 else angle
