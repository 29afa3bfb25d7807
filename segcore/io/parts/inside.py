"""Whether points are inside a surface."""

import numpy as np

from segcore.arrays import BoolArray, FloatArray, IntArray
from segcore.jit.decorators import inner_kernel, kernel

_MOST_ANGLES = 10**9  # solid angles that are computed for one model: 20 s


class InsideTest:
    """Tells whether points are inside a surface, as long as the time for it lasts.

    A point is inside if the oriented surface winds around it more than half a time.

    References
    ----------
    Jacobson, Kavan and Sorkine-Hornung, Robust inside-outside segmentation using generalized winding numbers, 2013.
    Solid angle: Van Oosterom and Strackee, The solid angle of a plane triangle, 1983.
    """

    def __init__(self, vertices: FloatArray, faces: IntArray) -> None:
        self._vertices, self._faces = vertices, faces
        self._left = _MOST_ANGLES

    def __call__(self, points: FloatArray) -> BoolArray:
        """(N,) True for points (N, 3) inside; False for all if there is no time left."""
        self._left -= len(points) * len(self._faces)
        if self._left < 0:
            return np.zeros(len(points), dtype=bool)
        inside: BoolArray = winding_numbers(points, self._vertices, self._faces) > 0.5
        return inside


@kernel
def winding_numbers(points: FloatArray, vertices: FloatArray, faces: IntArray) -> FloatArray:
    """(N,) the sum of the solid angles of faces (F, 3) at points (N, 3), over 4 pi. O(N F)."""
    numbers = np.zeros(len(points))
    corners = np.empty((3, 3))
    for i in range(len(points)):
        for f in range(len(faces)):
            for k in range(3):
                for axis in range(3):
                    corners[k, axis] = vertices[faces[f, k], axis] - points[i, axis]
            numbers[i] += _half_angle(corners)
    return numbers / (2.0 * np.pi)


@inner_kernel
def _half_angle(corners: FloatArray) -> float:
    """Half the solid angle of a triangle at the origin."""
    a, b, c = corners[0], corners[1], corners[2]
    la = np.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])
    lb = np.sqrt(b[0] * b[0] + b[1] * b[1] + b[2] * b[2])
    lc = np.sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2])
    ab = a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    bc = b[0] * c[0] + b[1] * c[1] + b[2] * c[2]
    ca = c[0] * a[0] + c[1] * a[1] + c[2] * a[2]
    volume = (
        a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    )
    return np.arctan2(volume, la * lb * lc + ab * lc + bc * la + ca * lb)
