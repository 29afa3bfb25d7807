"""Type aliases of arrays, and two reductions that several stages share."""

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
