"""Parts as rigid bodies: their mass, and the convex pieces for collisions."""

from collections.abc import Sequence
from dataclasses import dataclass

from segcore.io.parts.pieces import Part
from segcore.robots.convex import convex_hull, convex_pieces
from segcore.robots.masses import MassProperties, Solid, encloses_space, mass_properties
from segcore.robots.options import RobotOptions

_DECOMPOSED = 64  # parts, the largest, that are divided into convex pieces; the others get hulls. Set by hand
_CONVEX = 0.95  # of the volume of its hull, from which a part is its hull; set by hand

_FAILED = "CoACD failed to divide it: its collision piece is its convex hull."
_THIN = "It encloses no volume: its mass is that of its collision pieces."
_FLAT = "It is flat: it has no mass and no collision piece."


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """A part as a rigid body; lengths in metres."""

    shape: Solid  # the part, closed by caps as far as that is possible
    pieces: list[Solid]  # convex ones
    properties: MassProperties | None  # None if it is flat
    is_closed: bool  # whether the mass is that of the closed part
    note: str | None  # a sentence, if something is not as it should be


@dataclass(frozen=True, slots=True, eq=False)
class _Measured:
    """A part with its convex hull."""

    shape: Solid
    own: MassProperties | None  # None if it encloses no volume
    hull: Solid | None  # None if it is flat
    bound: MassProperties | None  # of the hull; None if it is nearly flat

    @property
    def size(self) -> float:
        """The volume of the hull."""
        return self.bound.volume if self.bound else 0.0

    @property
    def is_convex(self) -> bool:
        """Whether its hull is all that there is to it."""
        return self.bound is None or (self.own is not None and self.own.volume >= _CONVEX * self.size)


def bodies_of(parts: Sequence[Part], options: RobotOptions) -> list[Body]:
    """Return the parts as rigid bodies.

    Raises
    ------
    MissingPackage
        If convex pieces are needed and coacd is not installed.
    """
    measured = [_measured(part, options.density) for part in parts]
    bulky = {k: one for k, one in enumerate(measured) if not one.is_convex and options.collision == "pieces"}
    largest = sorted(bulky, key=lambda k: -bulky[k].size)[:_DECOMPOSED]
    wanted = {k: bulky[k].shape for k in sorted(largest)}
    pieces = convex_pieces(wanted, options)
    return [_body(one, pieces.get(k), k in wanted, options.density) for k, one in enumerate(measured)]


def _measured(part: Part, density: float) -> _Measured:
    shape, hull = Solid(part.vertices, part.faces), convex_hull(part.vertices)
    own = mass_properties([shape], density) if encloses_space(part.faces) else None
    return _Measured(shape, own, hull, mass_properties([hull], density) if hull else None)


def _body(one: _Measured, pieces: list[Solid] | None, was_divided: bool, density: float) -> Body:
    if one.hull is None or one.bound is None:
        return Body(one.shape, [], None, False, _FLAT)
    failed = was_divided and pieces is None
    if pieces is None or _volume(pieces) >= one.size:
        pieces = [one.hull]
    if one.own is None:
        note = f"{_THIN} {_FAILED}" if failed else _THIN
        return Body(one.shape, pieces, mass_properties(pieces, density), False, note)
    return Body(one.shape, pieces, one.own, True, _FAILED if failed else None)


def _volume(pieces: Sequence[Solid]) -> float:
    return sum(found.volume for piece in pieces if (found := mass_properties([piece], 1.0)))
