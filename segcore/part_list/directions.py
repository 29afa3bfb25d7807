"""Directions and rotations that are spread evenly."""

from functools import cache

import numpy as np

from segcore.arrays import FloatArray

_GOLDEN = (1.0 + np.sqrt(5.0)) / 2.0
# Of the spiral of rotations: psi is the root of psi**4 = psi + 4.
_PHI, _PSI = np.sqrt(2.0), 1.533751168755204288118041


@cache
def spread_directions(count: int) -> FloatArray:
    """(count, 3) unit vectors along a Fibonacci spiral on the sphere."""
    index = np.arange(count) + 0.5
    height = 1.0 - 2.0 * index / count
    angle = 2.0 * np.pi * index / _GOLDEN
    radius = np.sqrt(1.0 - height**2)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), height], axis=1)


@cache
def spread_rotations(count: int) -> FloatArray:
    """(count, 3, 3) rotations spread evenly over all.

    References
    ----------
    M. Alexa, Super-Fibonacci spirals: fast, low-discrepancy sampling of SO(3), CVPR 2022.
    """
    s = np.arange(count) + 0.5
    a, b = 2.0 * np.pi * s / _PHI, 2.0 * np.pi * s / _PSI
    r, R = np.sqrt(s / count), np.sqrt(1.0 - s / count)
    return _of_quaternions(np.stack([R * np.cos(b), r * np.sin(a), r * np.cos(a), R * np.sin(b)], axis=1))


def about_axis(axis: FloatArray, count: int) -> FloatArray:
    """(count, 3, 3) rotations about a unit vector by equal steps."""
    half = np.pi * np.arange(count) / count
    return _of_quaternions(np.concatenate([np.cos(half)[:, None], np.sin(half)[:, None] * axis], axis=1))


def turned_by(vector: FloatArray) -> FloatArray:
    """(3, 3) the rotation about a vector by its length."""
    angle = float(np.linalg.norm(vector))
    axis = vector / angle if angle > 0.0 else np.array([1.0, 0.0, 0.0])
    return _of_quaternions(np.array([[np.cos(0.5 * angle), *(np.sin(0.5 * angle) * axis)]]))[0]


def _of_quaternions(q: FloatArray) -> FloatArray:
    """(N, 3, 3) the rotations of unit quaternions (N, 4), the real part first."""
    w, x, y, z = q.T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), 2, 0)
