"""What the coordinates of a mesh mean: their unit of length, and the axis that points up."""

import difflib
from dataclasses import dataclass
from typing import Literal, cast, get_args

import numpy as np

from segcore.arrays import FloatArray
from segcore.errors import InvalidParameters

Unit = Literal["micron", "millimeter", "centimeter", "inch", "foot", "meter"]  # those of 3MF
Axis = Literal["y", "z"]

_METERS: dict[Unit, float] = {
    "micron": 1e-6, "millimeter": 1e-3, "centimeter": 1e-2, "inch": 0.0254, "foot": 0.3048, "meter": 1.0,
}  # fmt: skip
_OTHER_NAMES: dict[str, Unit] = {
    "um": "micron", "micrometer": "micron", "micrometre": "micron",
    "mm": "millimeter", "millimetre": "millimeter", "cm": "centimeter", "centimetre": "centimeter",
    "in": "inch", "inches": "inch", "ft": "foot", "feet": "foot", "m": "meter", "metre": "meter",
    "microns": "micron", "millimeters": "millimeter", "millimetres": "millimeter", "centimeters": "centimeter",
    "centimetres": "centimeter", "meters": "meter", "metres": "meter",
}  # fmt: skip
# From coordinates with one axis up to those with the other: a quarter of a turn about x.
_TURNS: dict[tuple[Axis, Axis], list[list[float]]] = {
    ("z", "y"): [[1, 0, 0], [0, 0, 1], [0, -1, 0]],
    ("y", "z"): [[1, 0, 0], [0, 0, -1], [0, 1, 0]],
}


@dataclass(frozen=True, slots=True)
class Coordinates:
    """The unit and the axis that a file names, or that somebody has said; None if they are not known.

    ``usual_up`` is the axis that programs show upwards if a file of this format does not name one.
    """

    unit: Unit | None = None
    up: Axis | None = None
    usual_up: Axis = "y"

    @property
    def shown_up(self) -> Axis:
        """The axis that points up in pictures."""
        return self.up or self.usual_up

    def scale_to(self, unit: Unit) -> float:
        """The factor from these coordinates to those in another unit; 1 if this unit is not known."""
        if self.unit is None or self.unit == unit:
            return 1.0
        factor = _METERS[self.unit] / _METERS[unit]
        return float(round(factor)) if factor >= 1 and np.isclose(factor, round(factor), rtol=1e-12) else factor

    def rotation_to(self, up: Axis) -> FloatArray:
        """The rotation (3, 3), for column vectors, to coordinates with another axis up; none if it is not known."""
        return np.array(_TURNS.get((self.up or up, up), np.eye(3)), dtype=np.float64)


UNKNOWN = Coordinates()


def unit_named(name: str) -> Unit:
    """Return the unit with a name, such as ``millimeter`` or ``mm``.

    Raises
    ------
    InvalidParameters
        If there is no such unit.
    """
    wanted = name.strip().lower()
    unit = _OTHER_NAMES.get(wanted, wanted)
    if unit not in _METERS:
        near = difflib.get_close_matches(wanted, [*_METERS, *_OTHER_NAMES], 1)
        meant = f", as in {near[0]!r}" if near else ""
        raise InvalidParameters(f"The unit must be one of {', '.join(_METERS)}, not {name[:40]!r}{meant}.")
    return unit


def axis_named(name: str) -> Axis:
    """Return the axis with a name, ``y`` or ``z``.

    Raises
    ------
    InvalidParameters
        If the name is another one.
    """
    wanted = name.strip().lower()
    if wanted not in get_args(Axis):
        raise InvalidParameters(f"The axis that points up must be y or z, not {name[:40]!r}.")
    return cast(Axis, wanted)
