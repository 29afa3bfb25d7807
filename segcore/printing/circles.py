"""The largest circle inside a plane region."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from segcore.arrays import FloatArray
from segcore.printing.booleans import library

if TYPE_CHECKING:
    from manifold3d import CrossSection

_SIDES = 128  # of the polygons for circles around corners of the region: exact to 1 in 3,000
_STEPS = 12  # of bisection: the radius is exact to 1 in 4,000
_CORE = 0.98  # of the largest radius: among the centres of circles of this size, the most central one is taken


@dataclass(frozen=True, slots=True, eq=False)
class Circle:
    """A circle in a plane."""

    centre: FloatArray  # (2,)
    radius: float


def largest_circle(region: CrossSection) -> Circle | None:
    """Return a circle inside a region with at least 0.98 of the largest radius; None if the region is empty.

    If circles of that size fit in many places, as in a long rectangle, it is the one nearest to the middle of the
    region. The region without a margin is what remains for the centres; the margin is found by bisection.
    """
    if region.is_empty():
        return None
    bounds = np.array(region.bounds()).reshape(2, 2)
    low, high = 0.0, 0.5 * float((bounds[1] - bounds[0]).min())
    for _ in range(_STEPS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if _without_margin(region, middle).is_empty() else (middle, high)
    remaining = _without_margin(region, _CORE * low)
    if low == 0 or remaining.is_empty():
        return None
    return Circle(_nearest(remaining.to_polygons(), bounds.mean(axis=0)), _CORE * low)


def _without_margin(region: CrossSection, margin: float) -> CrossSection:
    return region.offset(-margin, library().JoinType.Round, 2.0, _SIDES)


def _nearest(outlines: list[FloatArray], point: FloatArray) -> FloatArray:
    """(2,) the point nearest to ``point`` in the region with these outlines, each (N, 2)."""
    starts = np.concatenate(outlines)
    along = np.concatenate([np.roll(outline, -1, axis=0) for outline in outlines]) - starts
    if _is_inside(starts - point, along):
        return point
    length = np.maximum((along**2).sum(axis=1), np.finfo(np.float64).tiny)
    share = np.clip(((point - starts) * along).sum(axis=1) / length, 0.0, 1.0)
    places: FloatArray = starts + share[:, None] * along
    nearest: FloatArray = places[np.argmin(((places - point) ** 2).sum(axis=1))]
    return nearest


def _is_inside(starts: FloatArray, along: FloatArray) -> bool:
    """Whether the origin is inside closed outlines: a ray from it along x crosses them an odd number of times."""
    crosses = (starts[:, 1] > 0) != (starts[:, 1] + along[:, 1] > 0)
    start, edge = starts[crosses], along[crosses]
    return bool((start[:, 0] - start[:, 1] * edge[:, 0] / edge[:, 1] > 0).sum() % 2)
