"""RobotOptions: what can be chosen of a robot."""

from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

from segcore.errors import InvalidParameters

Joints: TypeAlias = Literal["fixed", "hinge"]
Collision: TypeAlias = Literal["pieces", "hull"]

DENSITY = 1000.0  # kg / m^3, that of water
LARGEST_DENSITY = 100_000.0
CONCAVITY = 0.2  # set by hand; at 0.1 CoACD takes about three times as long, see bench/RESULTS.md
LEAST_CONCAVITY = 0.01  # the least that CoACD takes
MOST_PIECES = 16  # of a part, set by hand
LARGEST_MOST_PIECES = 64
LARGEST_LENGTH = 10_000.0  # m


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotOptions:
    """What can be chosen.

    Raises
    ------
    InvalidParameters
        If a value is outside its range.
    """

    joints: Joints = "fixed"
    collision: Collision = "pieces"  # convex pieces, or one convex hull for each part
    concavity: float = CONCAVITY  # of a piece, in units of CoACD: the whole part is 2 long
    pieces: int = MOST_PIECES  # largest number for each part
    density: float = DENSITY  # kg / m^3
    length: float | None = None  # the longest side of the whole in metres; None keeps the size of the mesh

    def __post_init__(self) -> None:
        for name, value, kind in (("joints", self.joints, Joints), ("collision", self.collision, Collision)):
            if value not in get_args(kind):
                raise InvalidParameters(f"{name} must be one of {', '.join(get_args(kind))}, not {value!r}.")
        if not LEAST_CONCAVITY <= self.concavity <= 1:
            raise InvalidParameters(f"concavity must be from {LEAST_CONCAVITY:g} to 1, not {self.concavity}.")
        if not 1 <= self.pieces <= LARGEST_MOST_PIECES:
            raise InvalidParameters(f"pieces must be from 1 to {LARGEST_MOST_PIECES}, not {self.pieces}.")
        if not 0 < self.density <= LARGEST_DENSITY:
            raise InvalidParameters(
                f"density must be above 0 and at most {LARGEST_DENSITY:g} kg/m^3, not {self.density}."
            )
        if self.length is not None and not 0 < self.length <= LARGEST_LENGTH:
            raise InvalidParameters(f"length must be above 0 and at most {LARGEST_LENGTH:g} m, not {self.length}.")
