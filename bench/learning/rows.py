"""Rows of a table to learn from."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from segcore.arrays import FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Rows:
    """What one model contributes."""

    features: FloatArray  # (N, M)
    target: FloatArray  # (N,) in 0..1
    weight: FloatArray  # (N,), sum 1
