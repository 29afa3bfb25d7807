"""Type aliases of arrays, and a few operations that several stages share."""

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

FloatArray: TypeAlias = NDArray[np.float64]
IntArray: TypeAlias = NDArray[np.int32]
LongArray: TypeAlias = NDArray[np.int64]
BoolArray: TypeAlias = NDArray[np.bool_]


_VANISHES = 1e-100  # squares of smaller numbers leave the range of float64


def at_least(values: FloatArray, share: float) -> FloatArray:
    """(N,) values raised to at least a share of their mean; all 1 if the mean is 0."""
    mean = float(values.mean()) if len(values) else 0.0
    return np.maximum(values, share * mean) if mean > _VANISHES else np.ones_like(values)


def group_sums(group: NDArray[np.integer], values: FloatArray, count: int = 0) -> FloatArray:
    """(max(count, groups),) the sum of the values of each group 0, 1, ...; 0 for empty groups."""
    sums: FloatArray = np.bincount(group, values, minlength=count).astype(np.float64, copy=False)
    return sums


def pair_keys(pairs: NDArray[np.integer], count: int) -> LongArray:
    """(P,) a number for every pair (P, 2) of numbers 0..count - 1, the same for both orders of the pair."""
    keys: LongArray = pairs.min(axis=1).astype(np.int64) * count + pairs.max(axis=1)
    return keys


def largest_options(
    default: IntArray, item: NDArray[np.integer], option: NDArray[np.integer], value: FloatArray
) -> IntArray:
    """(N,) for every item the option for which the sum of its values is largest; of equal ones the last.

    Parameters
    ----------
    default : (N,) the option of items that have none.
    item, option, value : (P,) pairs of items and options, >= 0, which may be repeated.
    """
    count = int(option.max(initial=0)) + 1
    keys, which = np.unique(item.astype(np.int64) * count + option, return_inverse=True)
    ascending = np.argsort(group_sums(which, value), kind="stable")
    chosen = default.copy()
    chosen[keys[ascending] // count] = keys[ascending] % count
    return chosen


def significant(value: float) -> float:
    """Return a number with six significant digits, as reports give it."""
    return float(f"{value:.6g}")


def plane_axes(normal: FloatArray) -> FloatArray:
    """(2, 3) unit vectors that form a right-handed frame with a unit normal (3,)."""
    across = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
    across /= np.linalg.norm(across)
    return np.stack([across, np.cross(normal, across)])


def transformed(points: FloatArray, matrix: FloatArray) -> FloatArray:
    """(..., K) the images M p of points p (..., 3) under a matrix M (K, 3), without the threads of BLAS."""
    images: FloatArray = np.einsum("...j,kj->...k", points, matrix)
    return images
