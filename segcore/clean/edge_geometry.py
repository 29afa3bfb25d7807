"""What single dual edges look like: length, dihedral angle, the direction across."""

from dataclasses import dataclass

import numpy as np
from numba import njit

from segcore.arrays import FloatArray, at_least
from segcore.clean.surface import Surface

_TINY = float(np.finfo(float).tiny)
_SHORTEST = 1e-9  # least length of an edge that counts, in mean lengths


@dataclass(frozen=True, slots=True, eq=False)
class EdgeGeometry:
    """The mesh edges that the dual edges of a surface cross."""

    length: FloatArray  # (E,)
    dihedral: FloatArray  # (E,) angle between the normals in radians, 0 where flat, negative where concave
    typical_dihedral: float  # mean of its absolute value, weighted by length; > 0
    across: FloatArray  # (E, 3) unit vectors in the surface, perpendicular to the edge; 0 where there is none

    @classmethod
    def of(cls, surface: Surface) -> "EdgeGeometry":
        length, dihedral = edge_lengths(surface), dihedral_angles(surface)
        typical = float(np.dot(length, np.abs(dihedral)) / max(length.sum(), _TINY))
        return cls(length, dihedral, max(typical, _TINY), _across(surface))

    @property
    def positive_length(self) -> FloatArray:
        """(E,) lengths, those of degenerate edges raised a little above 0."""
        return at_least(self.length, _SHORTEST)


def edge_lengths(surface: Surface) -> FloatArray:
    """(E,) length of the mesh edge that a dual edge crosses."""
    return _lengths(surface.vertices, surface.edge_vertices)


def dihedral_angles(surface: Surface) -> FloatArray:
    """(E,) angle between the normals of the two faces in radians, 0 where flat, negative where concave.

    Zero where one of the faces is a sliver without a reliable normal.
    """
    return _dihedral_angles(surface.vertices, surface.faces, surface.normals, surface.edge_faces)


def _across(surface: Surface) -> FloatArray:
    a, b = surface.edge_vertices.T
    f, g = surface.edge_faces.T
    return _across_edges(surface.vertices, surface.normals, a, b, f, g)


@njit(cache=True)
def _lengths(vertices, ends):  # type: ignore[no-untyped-def]
    length = np.empty(len(ends))
    for e in range(len(ends)):
        p, q = vertices[ends[e, 0]], vertices[ends[e, 1]]
        length[e] = np.sqrt((q[0] - p[0]) ** 2 + (q[1] - p[1]) ** 2 + (q[2] - p[2]) ** 2)
    return length


@njit(cache=True)
def _across_edges(vertices, normals, a, b, f, g):  # type: ignore[no-untyped-def]
    across = np.zeros((len(a), 3))
    for e in range(len(a)):
        p, q, n, m = vertices[a[e]], vertices[b[e]], normals[f[e]], normals[g[e]]
        ux, uy, uz = q[0] - p[0], q[1] - p[1], q[2] - p[2]
        nx, ny, nz = n[0] + m[0], n[1] + m[1], n[2] + m[2]
        x, y, z = uy * nz - uz * ny, uz * nx - ux * nz, ux * ny - uy * nx
        size = np.sqrt(x * x + y * y + z * z)
        if size > 0.0:
            across[e, 0], across[e, 1], across[e, 2] = x / size, y / size, z / size
    return across


@njit(cache=True)
def _dihedral_angles(vertices, faces, normals, pairs):  # type: ignore[no-untyped-def]
    theta = np.zeros(len(pairs))
    for e in range(len(pairs)):
        f, g = pairs[e, 0], pairs[e, 1]
        n, m = normals[f], normals[g]
        x, y, z = n[1] * m[2] - n[2] * m[1], n[2] * m[0] - n[0] * m[2], n[0] * m[1] - n[1] * m[0]
        cosine = n[0] * m[0] + n[1] * m[1] + n[2] * m[2]
        if cosine == 0.0 and x == 0.0 and y == 0.0 and z == 0.0:
            continue
        angle = np.arctan2(np.sqrt(x * x + y * y + z * z), cosine)
        side = 0.0
        for k in range(3):
            for axis in range(3):
                side += n[axis] * (vertices[faces[g, k], axis] - vertices[faces[f, k], axis])
        theta[e] = -angle if side > 0.0 else angle
    return theta
