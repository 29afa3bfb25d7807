"""Tangent frames: two unit vectors that complete a unit normal to a right-handed frame.

Duff et al., Building an orthonormal basis, revisited, Journal of Computer Graphics Techniques 6, 2017.
"""

import numpy as np

from segcore.arrays import FloatArray
from segcore.jit.decorators import inner_kernel, kernel


def tangent_frames(normals: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Frames (u, v), each (N, 3), of unit normals (N, 3): u x v is the normal."""
    u, v = np.empty_like(normals), np.empty_like(normals)
    _tangent_frames(normals, u, v)
    return u, v


@inner_kernel
def tangent_vectors(x, y, z):  # type: ignore[no-untyped-def]
    """The two vectors of the frame of a unit normal, three numbers each."""
    sign = 1.0 if z >= 0.0 else -1.0
    a = -1.0 / (sign + z)
    b = x * y * a
    return (1.0 + sign * x**2 * a, sign * b, -sign * x), (b, sign + y**2 * a, -y)


@kernel
def _tangent_frames(normals: FloatArray, u: FloatArray, v: FloatArray) -> None:
    for i in range(len(normals)):
        one, other = tangent_vectors(normals[i, 0], normals[i, 1], normals[i, 2])
        u[i, 0], u[i, 1], u[i, 2] = one
        v[i, 0], v[i, 1], v[i, 2] = other
