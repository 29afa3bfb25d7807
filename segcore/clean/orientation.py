"""Compiled kernels for normals, areas, enclosed volumes and the orientation of faces."""

import numpy as np

from segcore.arrays import BoolArray, FloatArray, IntArray
from segcore.jit.decorators import inner_kernel, kernel
from segcore.threads import in_blocks

# Area over squared longest edge, and height over the extent of the surface, below which a normal is rounding noise. Set
# by hand: coordinates in single precision are rounded by 6e-8 of the extent.
_SLIVER = 1e-6
_LEAST_HEIGHT = 1e-6


@kernel
def patch_volumes(
    vertices: FloatArray, faces: IntArray, patch: IntArray, is_flipped: BoolArray, count: int
) -> tuple[FloatArray, FloatArray]:
    """Areas (P,) and enclosed volumes (P,) of patches of faces.

    A volume is positive if the faces look outward. The volume of an open patch is that of the cone to its centroid.

    Parameters
    ----------
    patch : (F,) the patch 0..P - 1 of every face.
    is_flipped : (F,) True for faces that count with the opposite orientation.
    count : P.
    """
    area = np.zeros(count)
    moment = np.zeros((count, 3))
    direction = np.zeros((count, 3))
    volume = np.zeros(count)
    for f in range(len(faces)):
        (cx, cy, cz), (nx, ny, nz) = _centroid_and_cross(vertices, faces[f])
        p = patch[f]
        doubled = np.sqrt(nx * nx + ny * ny + nz * nz)
        sign = -1.0 if is_flipped[f] else 1.0
        area[p] += 0.5 * doubled
        moment[p, 0] += 0.5 * doubled * cx
        moment[p, 1] += 0.5 * doubled * cy
        moment[p, 2] += 0.5 * doubled * cz
        direction[p, 0] += sign * nx
        direction[p, 1] += sign * ny
        direction[p, 2] += sign * nz
        volume[p] += sign * (cx * nx + cy * ny + cz * nz) / 6.0
    for p in range(count):
        if area[p] > 0.0:
            for axis in range(3):
                volume[p] -= moment[p, axis] / area[p] * direction[p, axis] / 6.0
    return area, volume


@kernel
def flipped(faces: IntArray, is_flipped: BoolArray) -> IntArray:
    """(F, 3) the faces, some of them with their last two corners exchanged."""
    oriented = faces.copy()
    for f in range(len(faces)):
        if is_flipped[f]:
            oriented[f, 1], oriented[f, 2] = faces[f, 2], faces[f, 1]
    return oriented


def reliable_normals(vertices: FloatArray, faces: IntArray) -> tuple[FloatArray, FloatArray]:
    """Unit normals (F, 3), zero for slivers without a reliable direction, and areas (F,) of faces of extent 1."""
    normals = np.zeros((len(faces), 3))
    areas = np.empty(len(faces))
    in_blocks(_write_normals, len(faces), vertices, faces, normals, areas)
    return normals, areas


@kernel
def _write_normals(start, end, vertices, faces, normals, areas):  # type: ignore[no-untyped-def]
    for f in range(start, end):
        _, (nx, ny, nz) = _centroid_and_cross(vertices, faces[f])
        doubled = np.sqrt(nx * nx + ny * ny + nz * nz)
        areas[f] = 0.5 * doubled
        longest = 0.0
        for k in range(3):
            a, b = faces[f, k], faces[f, (k + 1) % 3]
            squared = 0.0
            for axis in range(3):
                squared += (vertices[a, axis] - vertices[b, axis]) ** 2
            longest = max(longest, squared)
        if areas[f] > max(_SLIVER * longest, 0.5 * _LEAST_HEIGHT * np.sqrt(longest)):
            normals[f, 0], normals[f, 1], normals[f, 2] = nx / doubled, ny / doubled, nz / doubled


@inner_kernel
def _centroid_and_cross(vertices, face):  # type: ignore[no-untyped-def]
    """The centroid of a face, and the cross product of two of its edges."""
    a, b, c = vertices[face[0]], vertices[face[1]], vertices[face[2]]
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    vx, vy, vz = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    centroid = ((a[0] + b[0] + c[0]) / 3.0, (a[1] + b[1] + c[1]) / 3.0, (a[2] + b[2] + c[2]) / 3.0)
    return centroid, (uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx)
