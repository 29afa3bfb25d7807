"""PrintOptions: what can be chosen of a file for printing."""

import math
import re
from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

from segcore.errors import InvalidParameters

Connectors: TypeAlias = Literal["none", "dowel", "peg"]
Place: TypeAlias = Literal["plate", "assembled"]
Slicer: TypeAlias = Literal["any", "prusa", "bambu"]

CLEARANCE = 0.2  # mm, set by hand: a usual fit of filament printers
LARGEST_CLEARANCE = 5.0  # mm
MOST_SLOTS = 16  # of filament
_LEAST_BED = 50.0  # mm
LARGEST_LENGTH = 10_000.0  # mm, of a model and of a bed
BED_PATTERN = r"^[0-9]{1,6}(\.[0-9]{1,3})?(x[0-9]{1,6}(\.[0-9]{1,3})?){2}$"


@dataclass(frozen=True, slots=True, kw_only=True)
class PrintOptions:
    """What can be chosen; lengths are in millimetres.

    Raises
    ------
    InvalidParameters
        If a value is outside its range.
    """

    connectors: Connectors = "dowel"
    clearance: float = CLEARANCE  # diameter of a hole minus that of what fits into it
    bed: str | None = None  # width, depth and height, such as 250x250x250; larger parts are divided
    slots: int | None = None  # filaments; None for one per colour
    size: float | None = None  # the longest side of the whole; None keeps the size of the mesh
    place: Place = "plate"  # side by side on the bed, or as in the mesh
    slicer: Slicer = "any"  # for which the file names the extruder of every object

    def __post_init__(self) -> None:
        for name, value, kind in (
            ("connectors", self.connectors, Connectors),
            ("place", self.place, Place),
            ("slicer", self.slicer, Slicer),
        ):
            if value not in get_args(kind):
                raise InvalidParameters(f"{name} must be one of {', '.join(get_args(kind))}, not {value!r}.")
        if not 0 <= self.clearance <= LARGEST_CLEARANCE:
            raise InvalidParameters(f"clearance must be from 0 to {LARGEST_CLEARANCE:g} mm, not {self.clearance}.")
        if self.slots is not None and not 1 <= self.slots <= MOST_SLOTS:
            raise InvalidParameters(f"slots must be from 1 to {MOST_SLOTS}, not {self.slots}.")
        if self.size is not None and not 0 < self.size <= LARGEST_LENGTH:
            raise InvalidParameters(f"size must be above 0 and at most {LARGEST_LENGTH:g} mm, not {self.size}.")
        if self.bed is not None and not (re.fullmatch(BED_PATTERN, self.bed) and min(self.sides) >= _LEAST_BED):
            raise InvalidParameters(
                f"bed must be three lengths of at least {_LEAST_BED:g} mm, such as 250x250x250, not {self.bed[:40]!r}."
            )

    @property
    def sides(self) -> tuple[float, float, float]:
        """Width, depth and height of the bed; infinite without one."""
        if self.bed is None:
            return (math.inf,) * 3
        width, depth, height = map(float, self.bed.split("x"))
        return width, depth, height
