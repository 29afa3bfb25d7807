"""Connectors at contacts: dowels for two holes, or pegs on one part for a hole in the other."""

from __future__ import annotations

from collections.abc import Iterator, MutableMapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from segcore.arrays import FloatArray
from segcore.printing.booleans import contains, cylinder, hole_radius
from segcore.printing.contacts import Contact
from segcore.printing.options import PrintOptions

if TYPE_CHECKING:
    from manifold3d import Manifold

# Lengths in mm and ratios, all set by hand for filament printers with a nozzle of 0.4 mm.
_LEAST_RADIUS = 1.0
_LARGEST_RADIUS = 5.0
LARGEST_DEPTH = 12.0  # in one part
_WALL = 1.2  # around a hole: three lines
_SHARE = 0.5  # of the radius of the largest circle: half of it remains as wall
_SMALLER = (1.0, 0.75, 0.5)  # sizes that are tried, largest first
_DEPTHS = (2.0, 1.5, 1.0)  # depths in radii that are tried, largest first
_LARGEST_DEVIATION = 0.5  # of a border from its plane, in radii of the largest circle


@dataclass(frozen=True, slots=True, eq=False)
class Connector:
    """A dowel or a peg along the normal of a contact; lengths in mm."""

    radius: float
    hole_radius: float
    depth: float  # of the dowel or the peg in each part with a hole
    hole_depth: float  # from the plane of the contact
    holes: tuple[int, ...]  # the parts with a hole
    dowel: Manifold | None  # None for a peg, which is a piece of the other part


@dataclass(frozen=True, slots=True, eq=False)
class Joint:
    """A contact with its connector, or the reason why it has none."""

    contact: Contact
    connector: Connector | None
    reason: str | None


def add_connectors(
    solids: MutableMapping[int, Manifold], contacts: list[Contact], options: PrintOptions
) -> list[Joint]:
    """Add a connector to every contact that has room for one; the solids of the parts are replaced.

    Parameters
    ----------
    solids : by part; parts that are no solids are absent.
    """
    order = sorted(range(len(contacts)), key=lambda k: -contacts[k].radius)  # the strongest first
    joints = {k: _joint(solids, contacts[k], options) for k in order}
    return [joints[k] for k in range(len(contacts))]


def _joint(solids: MutableMapping[int, Manifold], contact: Contact, options: PrintOptions) -> Joint:
    reason = _obstacle(solids, contact, options)
    if reason is not None:
        return Joint(contact, None, reason)
    assert contact.normal is not None
    for radius, depth in _sizes(contact):
        connector = (_dowel if options.connectors == "dowel" else _peg)(solids, contact, radius, depth, options)
        if connector is not None:
            return Joint(contact, connector, None)
    return Joint(contact, None, f"the wall is thin: no hole with {_WALL:g} mm of material around it fits")


def _obstacle(solids: MutableMapping[int, Manifold], contact: Contact, options: PrintOptions) -> str | None:
    """The reason why a contact cannot have a connector of any size; None if it may have one."""
    if options.connectors == "none":
        return "no connectors were asked for"
    if not solids.keys() >= set(contact.parts):
        return "a part is not a closed solid"
    if contact.normal is None:
        return "the border lies along a line, so that the contact has no plane"
    if contact.radius == 0:
        return "the parts have no common region in the plane of the contact"
    if contact.radius * _SHARE < _LEAST_RADIUS:
        return (
            f"the contact is small: the largest circle in it has a diameter of {2 * contact.radius:.3g} mm, and "
            f"{2 * _LEAST_RADIUS / _SHARE:g} mm are needed"
        )
    if contact.deviation > _LARGEST_DEVIATION * contact.radius:
        return f"the contact is not nearly plane: its border leaves the plane by {contact.deviation:.3g} mm"
    return None


def _sizes(contact: Contact) -> Iterator[tuple[float, float]]:
    """Yield radii and depths, largest first."""
    for share in _SMALLER:
        radius = share * min(_SHARE * contact.radius, _LARGEST_RADIUS)
        if radius >= _LEAST_RADIUS:
            for depth in _DEPTHS:
                yield radius, min(depth * radius, LARGEST_DEPTH)


@dataclass(frozen=True, slots=True, eq=False)
class _Hole:
    removed: Manifold
    needed: Manifold  # what has to be material: the hole with walls

    def fits(self, solid: Manifold) -> bool:
        return contains(solid, self.needed)


def _hole(contact: Contact, direction: FloatArray, radius: float, depth: float) -> _Hole:
    """A hole from the plane of a contact, begun before it as far as the border leaves the plane."""
    margin = contact.deviation + _WALL
    return _Hole(
        cylinder(contact.centre, direction, radius, -margin, depth),
        cylinder(contact.centre, direction, radius + _WALL, contact.deviation, depth + _WALL),
    )


def _dowel(
    solids: MutableMapping[int, Manifold], contact: Contact, radius: float, depth: float, options: PrintOptions
) -> Connector | None:
    one, other = contact.parts
    normal = contact.normal
    assert normal is not None
    wide, deep = hole_radius(radius, options.clearance), depth + 0.5 * options.clearance + contact.deviation
    holes = {one: _hole(contact, -normal, wide, deep), other: _hole(contact, normal, wide, deep)}
    if not all(hole.fits(solids[part]) for part, hole in holes.items()):
        return None
    for part, hole in holes.items():
        solids[part] -= hole.removed
    dowel = cylinder(contact.centre, normal, radius, -depth - contact.deviation, depth + contact.deviation)
    return Connector(radius, wide, depth + contact.deviation, deep, (one, other), dowel)


def _peg(
    solids: MutableMapping[int, Manifold], contact: Contact, radius: float, depth: float, options: PrintOptions
) -> Connector | None:
    """A peg on the smaller part, or on the larger one if the other has no room for a hole."""
    one, other = sorted(contact.parts, key=lambda part: solids[part].volume())
    return _peg_on(solids, contact, (one, other), radius, depth, options) or _peg_on(
        solids, contact, (other, one), radius, depth, options
    )


def _peg_on(
    solids: MutableMapping[int, Manifold],
    contact: Contact,
    parts: tuple[int, int],
    radius: float,
    depth: float,
    options: PrintOptions,
) -> Connector | None:
    """A peg on the first part for a hole in the second."""
    normal = contact.normal
    assert normal is not None
    own, other = parts
    direction = normal if own == contact.parts[0] else -normal
    wide, deep = hole_radius(radius, options.clearance), depth + 0.5 * options.clearance + contact.deviation
    hole = _hole(contact, direction, wide, deep)
    root = cylinder(contact.centre, direction, radius, -contact.deviation - radius, -contact.deviation)
    if not (hole.fits(solids[other]) and contains(solids[own], root)):
        return None
    solids[other] -= hole.removed
    end = depth + contact.deviation
    solids[own] += cylinder(contact.centre, direction, radius, -contact.deviation - radius, end)
    return Connector(radius, wide, end, deep, (other,), None)
