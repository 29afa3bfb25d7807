"""Groups of congruent parts, such as the four legs of a table."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from segcore.arrays import FloatArray
from segcore.errors import InvalidParameters
from segcore.part_list.congruence import Fit, congruence, in_order
from segcore.part_list.part_shape import PartShape
from segcore.part_list.tolerance import LARGEST_TOLERANCE, TOLERANCE

_MOST_COMPARED = 1000  # parts, those with the largest area; set by hand
# Pairs of parts that are aligned, 0.04 s each; pairs that look alike and are not equal take five times as long. Set by
# hand, so that no list takes minutes.
_MOST_FITS, _MISFIT = 1000, 5
# Times the tolerance: differences of parts that are not compared any further. Set by hand.
_AREA, _LENGTHS = 10.0, 3.0


@dataclass(frozen=True, slots=True, eq=False)
class Copy:
    """A part of a group, and the map of the first one to it."""

    part: int
    transform: FloatArray  # (4, 4) for column vectors (x, y, z, 1), in units of the mesh
    is_mirrored: bool
    residual: float  # the largest deviation of points of either part from the other one, in units of the mesh
    mean_residual: float  # the root of their mean square, in units of the mesh
    relative_residual: float  # the largest deviation over the diagonal of the box of the first part


@dataclass(frozen=True, slots=True)
class Repeat:
    """Parts that are congruent to the first of them."""

    copies: tuple[Copy, ...]  # two or more, in the order of their numbers; the first maps to itself

    @property
    def parts(self) -> tuple[int, ...]:
        """The numbers of the parts, ascending."""
        return tuple(copy.part for copy in self.copies)


@dataclass(frozen=True, slots=True)
class Repeats:
    """The groups of congruent parts, in the order of their first parts."""

    groups: tuple[Repeat, ...]
    is_complete: bool  # False if there were too many parts to compare all


def find_repeats(shapes: Sequence[PartShape | None], tolerance: float = TOLERANCE) -> Repeats:
    """The groups of congruent parts.

    Every part is compared with the first parts of the groups so far, and joins the one that it deviates least from, if
    that is at most the tolerance. So every part of a group fits to its first one. The 1,000 parts with the largest area
    are compared. After 1,000 pairs that had to be aligned, only copies with equal faces in the same order are found; a
    pair that looks alike and is not congruent counts as five.

    Parameters
    ----------
    shapes : of every part, None for a part that is equal to none, such as one without area.
    tolerance : largest deviation, in diagonals of the box of the first part.

    Raises
    ------
    InvalidParameters
        If the tolerance is not above 0 and at most 0.1.
    """
    if not 0.0 < tolerance <= LARGEST_TOLERANCE:
        raise InvalidParameters(f"The tolerance must be above 0 and at most {LARGEST_TOLERANCE}, not {tolerance}.")
    found = _Groups(tolerance)
    known = {part: shape for part, shape in enumerate(shapes) if shape is not None}
    largest = sorted(known, key=lambda part: -known[part].area)[:_MOST_COMPARED]
    for part in sorted(largest):
        found.add(part, known[part])
    groups = tuple(Repeat(tuple(copies)) for copies in found.copies.values() if len(copies) > 1)
    return Repeats(groups, found.is_complete and len(largest) == len(known))


class _Groups:
    """The groups so far, by their first parts."""

    def __init__(self, tolerance: float) -> None:
        self.copies: dict[int, list[Copy]] = {}
        self.is_complete = True
        self._shapes: dict[int, PartShape] = {}
        self._tolerance = tolerance
        self._fits_left = _MOST_FITS

    def add(self, part: int, shape: PartShape) -> None:
        """Add a part to the group that it fits best to, or as the first one of a new group."""
        alike = _alike(self._shapes, shape, self._tolerance)
        fits = [(fit, first) for first in alike if (fit := self._fit(self._shapes[first], shape)) is not None]
        if fits:
            fit, first = min(fits, key=lambda found: found[0].largest)
            self.copies[first].append(_copy(part, self._shapes[first], shape, fit))
        else:
            self.copies[part], self._shapes[part] = [Copy(part, np.eye(4), False, 0.0, 0.0, 0.0)], shape

    def _fit(self, first: PartShape, shape: PartShape) -> Fit | None:
        fit = in_order(first, shape, self._tolerance)
        if fit is not None:
            return fit
        if self._fits_left <= 0:
            self.is_complete = False
            return None
        fit = congruence(first, shape, self._tolerance)
        self._fits_left -= _MISFIT if fit is None else 1
        return fit


def _alike(firsts: Mapping[int, PartShape], shape: PartShape, tolerance: float) -> list[int]:
    """The parts whose area, spreads and reach nearly agree with those of a part."""
    if not firsts:
        return []
    areas = np.array([first.area for first in firsts.values()])
    lengths = np.array([[*first.spread, first.reach, first.size] for first in firsts.values()])
    differs = np.abs(lengths[:, :4] - [*shape.spread, shape.reach]).max(axis=1)
    is_alike = np.abs(np.log(areas / shape.area)) <= _AREA * tolerance
    is_alike &= differs <= _LENGTHS * tolerance * lengths[:, 4]
    return [first for first, alike in zip(firsts, is_alike.tolist(), strict=True) if alike]


def _copy(part: int, first: PartShape, shape: PartShape, fit: Fit) -> Copy:
    transform = np.eye(4)
    transform[:3, :3] = fit.rotation
    transform[:3, 3] = shape.centre + fit.shift - fit.rotation @ first.centre
    return Copy(part, transform, fit.is_mirrored, fit.largest, fit.mean, fit.largest / first.size)
