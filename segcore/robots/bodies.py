"""Parts as rigid bodies: their mass, and the convex pieces for collisions."""

from collections.abc import Sequence
from dataclasses import dataclass

from segcore.io.parts.pieces import Part
from segcore.robots.convex import convex_hull, convex_pieces
from segcore.robots.masses import MassProperties, Solid, mass_properties
from segcore.robots.options import RobotOptions

_DECOMPOSED = 64  # parts, the largest, that are divided into convex pieces; the others get hulls. Set by hand

_OPEN = "It is not a closed solid: its mass is that of its collision pieces."
_FLAT = "It is flat: it has no mass and no collision piece."


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """A part as a rigid body; lengths in metres."""

    shape: Solid  # the part, closed by caps as far as that is possible
    pieces: list[Solid]  # convex ones
    properties: MassProperties | None  # None if it is flat
    note: str | None  # a sentence, if the mass is not that of the closed part


def bodies_of(parts: Sequence[Part], options: RobotOptions) -> list[Body]:
    """Return the parts as rigid bodies.

    Raises
    ------
    MissingPackage
        If convex pieces are needed and coacd is not installed.
    """
    hulls = [convex_hull(part.vertices) for part in parts]
    bounds = [mass_properties([hull], options.density) if hull else None for hull in hulls]
    volumes = [bound.volume if bound else 0.0 for bound in bounds]
    largest = set(sorted(range(len(parts)), key=lambda k: -volumes[k])[:_DECOMPOSED])
    bodies = []
    for k, (part, hull, bound) in enumerate(zip(parts, hulls, bounds, strict=True)):
        shape = Solid(part.vertices, part.faces)
        own = mass_properties([shape], options.density) if part.is_solid else None
        if hull is None or bound is None:
            bodies.append(Body(shape, [], None, _FLAT))
            continue
        pieces = [hull]
        if options.collision == "pieces" and k in largest:
            pieces = convex_pieces(shape, hull, own.volume / bound.volume if own else None, options)
        if own is None:
            bodies.append(Body(shape, pieces, mass_properties(pieces, options.density), _OPEN))
        else:
            bodies.append(Body(shape, pieces, own, None))
    return bodies
