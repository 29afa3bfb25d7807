"""Tangent frames: two unit vectors that complete a unit normal to a right-handed frame.

Duff et al., Building an orthonormal basis, revisited, Journal of Computer Graphics Techniques 6, 2017.
"""

import numpy as np
from numba import njit

from segcore.arrays import FloatArray


def tangent_frames(normals: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Frames (u, v), each (N, 3), of unit normals (N, 3): u x v is the normal."""
    u, v = np.empty_like(normals), np.empty_like(normals)
    _tangent_frames(normals, u, v)
    return u, v


@njit(cache=True, nogil=True)
def tangent_frame(normal: FloatArray, u: FloatArray, v: FloatArray) -> None:
    """Write the frame of a unit normal (3,) into ``u`` and ``v``."""
    sign = 1.0 if normal[2] >= 0.0 else -1.0
    a = -1.0 / (sign + normal[2])
    b = normal[0] * normal[1] * a
    u[0], u[1], u[2] = 1.0 + sign * normal[0] ** 2 * a, sign * b, -sign * normal[0]
    v[0], v[1], v[2] = b, sign + normal[1] ** 2 * a, -normal[1]


@njit(cache=True, nogil=True)
def _tangent_frames(normals: FloatArray, u: FloatArray, v: FloatArray) -> None:
    for i in range(len(normals)):
        tangent_frame(normals[i], u[i], v[i])
