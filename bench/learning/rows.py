"""The rows of a table that a model is fitted to."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from segcore.arrays import BoolArray, FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Rows:
    """Features, targets and weights of some rows."""

    features: FloatArray  # (N, M)
    target: FloatArray  # (N,) in 0..1
    weight: FloatArray  # (N,) >= 0; their sum is 1 for the rows of one model

    def part(self, chosen: BoolArray) -> Rows:
        """Return the rows for which (N,) ``chosen`` is True."""
        return Rows(self.features[chosen], self.target[chosen], self.weight[chosen])

    def columns(self, chosen: Sequence[int]) -> Rows:
        """Return the rows with some of the features alone."""
        return Rows(self.features[:, list(chosen)], self.target, self.weight)


def concatenated(tables: Sequence[Rows]) -> Rows:
    """Return the rows of all tables in one, in double precision."""
    return Rows(
        features=np.concatenate([rows.features for rows in tables]).astype(np.float64),
        target=np.concatenate([rows.target for rows in tables]).astype(np.float64),
        weight=np.concatenate([rows.weight for rows in tables]).astype(np.float64),
    )
