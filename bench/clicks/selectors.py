"""Ways to find a part from marked faces: Cleave's, and plain region growing for comparison."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Protocol

import numpy as np

from segcore.edit.distances import distances_from

if TYPE_CHECKING:
    from bench.clicks.person import Shape
    from segcore.arrays import BoolArray
    from segcore.edit.guide import Guide


class Selector(Protocol):
    """Finds the part (F,) that a person means who marked some faces of a shape."""

    def __call__(self, inside: Sequence[int], outside: Sequence[int]) -> BoolArray: ...


class GuideSelector:
    """Cleave's guide."""

    def __init__(self, guide: Guide, shape: Shape) -> None:
        self._guide, self._input_face = guide, shape.input_face

    def __call__(self, inside: Sequence[int], outside: Sequence[int]) -> BoolArray:
        part: BoolArray = self._guide.part(self._input_face[list(inside)], self._input_face[list(outside)])
        return part[self._input_face]


class RegionGrowing:
    """The faces that are nearer to the marks inside than to those outside, up to a share of the total area.

    Distances are those of the centres along the surface.
    """

    def __init__(self, shape: Shape, share: float) -> None:
        self._shape, self._most = shape, share * float(shape.area.sum())

    def __call__(self, inside: Sequence[int], outside: Sequence[int]) -> BoolArray:
        shape = self._shape
        own = distances_from(shape.rows, shape.step, np.array(inside), np.inf)
        other = distances_from(shape.rows, shape.step, np.array(outside, dtype=np.int64), np.inf)
        order = np.argsort(own, kind="stable")
        order = order[(own < other)[order]]
        grown = np.zeros(len(own), dtype=bool)
        grown[order[np.cumsum(shape.area[order]) <= self._most]] = True
        grown[list(inside)] = True
        return grown
