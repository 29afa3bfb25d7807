"""The plan of a robot: the parts of a segmented mesh as links in metres, with joints between them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse.csgraph import breadth_first_order

from segcore.arrays import FloatArray
from segcore.clean.surface import build_surface
from segcore.coordinates import Unit
from segcore.errors import InvalidParameters
from segcore.hierarchy import Hierarchy
from segcore.io.converting import converted
from segcore.io.names import SegmentNames, identifiers, segment_names
from segcore.io.palette import SegmentColors, segment_colors
from segcore.io.parts.pieces import closed_groups, labels_on, positions
from segcore.mesh import Mesh
from segcore.robots.bodies import Body, bodies_of
from segcore.robots.contacts import Contact, Pair, find_contacts, joint_tree, why_fixed
from segcore.robots.options import LARGEST_LENGTH, Joints, RobotOptions

_MOST_LINKS = 1024  # set by hand: more are scattered pieces
_RESERVED = ("world", "floor")  # names that simulators and the scene use


@dataclass(frozen=True, slots=True, eq=False)
class Joint:
    """The connection of a link to its parent."""

    parent: int  # its place among the links
    kind: Joints
    axis: FloatArray | None  # (3,) of a hinge, a unit vector
    reason: str | None  # why it is fixed, if hinges were asked for


@dataclass(frozen=True, slots=True, eq=False)
class Link:
    """A part as a link; lengths in metres, in the coordinates of the whole, to which all axes are parallel."""

    name: str  # an identifier
    title: str  # the name of the part
    label: int
    color: FloatArray  # (3,) sRGB in 0..1
    origin: FloatArray  # (3,) of its own coordinates, on the axis of its joint
    body: Body
    joint: Joint | None  # None for the root


@dataclass(frozen=True, slots=True, eq=False)
class RobotPlan:
    """What is written and reported."""

    options: RobotOptions
    unit: Unit | None  # of the mesh; None if it is not known and taken as metres
    scale: float  # that was applied to lengths in metres
    links: list[Link]  # the root first, each after its parent
    touching: list[Pair]  # the places of links with a common border


def plan_robot(
    mesh: Mesh,
    hierarchy: Hierarchy,
    segments: int | None = None,
    options: RobotOptions | None = None,
    *,
    names: SegmentNames | None = None,
    part_colors: SegmentColors | None = None,
) -> RobotPlan:
    """Return the parts of a level as links, in metres with z up, the lowest collision piece on the plane z = 0.

    The root is the part with the largest volume. Joints are along a spanning tree of the contacts, the longest borders
    first. Mass and inertia are those of the closed parts. A mesh whose unit is not known is taken as it is in metres.

    Parameters
    ----------
    names, part_colors : of segments by label, in place of ``segment k`` and of the fixed colours.

    Raises
    ------
    InvalidParameters
        If ``segments`` is not in 1..max_segments or above 1,024, no part has an area, or the whole is too large.
    MissingPackage
        If convex pieces are needed and coacd is not installed.
    """
    options = options or RobotOptions()
    count = len(hierarchy.segment_nodes(segments))
    if count > _MOST_LINKS:
        raise InvalidParameters(f"A robot has at most {_MOST_LINKS} links, not {count}: choose fewer segments.")
    moved, scale = _in_metres(mesh, options.length)
    surface = build_surface(moved)
    vertices, labels = positions(moved, surface), labels_on(surface, hierarchy.labels(segments))
    parts = list(closed_groups(vertices, surface.faces, labels, count))
    if not parts:
        raise InvalidParameters("The mesh has no face with an area, so that there is nothing to simulate.")
    place = np.zeros(count, dtype=np.int32)
    place[[part.label for part in parts]] = np.arange(len(parts))
    boxes = np.stack([[part.vertices.min(axis=0), part.vertices.max(axis=0)] for part in parts])
    contacts = find_contacts(surface, vertices, place[labels], boxes.mean(axis=1))
    bodies = bodies_of(parts, options)
    if all(body.properties is None for body in bodies):
        raise InvalidParameters("All parts are flat, so that no part has a mass.")
    order, parents = _tree(bodies, contacts, boxes)
    titles, colors = segment_names(names, count), segment_colors(count, part_colors)
    links: list[Link] = []
    for k, name in zip(order, identifiers([titles[parts[k].label] for k in order], _RESERVED), strict=True):
        joint, origin = None, _ground(bodies)
        if links:
            joint = _joint(k, parents[k], order.index(parents[k]), contacts, len(parts), options.joints)
            origin = _middle(k, parents[k], contacts, boxes)
        label = parts[k].label
        links.append(Link(name, titles[label], label, colors[label], origin, bodies[k], joint))
    touching = [(order.index(one), order.index(other)) for one, other in contacts]
    return RobotPlan(options, mesh.coordinates.unit, scale, links, touching)


def _tree(bodies: Sequence[Body], contacts: Mapping[Pair, Contact], boxes: FloatArray) -> tuple[list[int], list[int]]:
    """The parts, each after its parent, and the parent of every part."""
    volumes = [body.properties.volume if body.properties else 0.0 for body in bodies]
    order, parents = breadth_first_order(joint_tree(contacts, boxes), int(np.argmax(volumes)), directed=False)
    return order.tolist(), parents.tolist()


def _ground(bodies: Sequence[Body]) -> FloatArray:
    """(3,) the point of the plane on which the whole stands that is the origin of the root."""
    lowest = min((float(piece.vertices[:, 2].min()) for body in bodies for piece in body.pieces), default=0.0)
    return np.array([0.0, 0.0, lowest])


def _joint(child: int, parent: int, place: int, contacts: Mapping[Pair, Contact], count: int, wanted: Joints) -> Joint:
    """The joint of a part and its parent, whose place among the links is given."""
    if wanted == "fixed":
        return Joint(place, "fixed", None, None)
    pair = (min(child, parent), max(child, parent))
    reason = why_fixed(pair, contacts, count)
    plane = None if reason else contacts[pair].plane
    return Joint(place, "hinge" if plane else "fixed", plane.normal if plane else None, reason)


def _middle(child: int, parent: int, contacts: Mapping[Pair, Contact], boxes: FloatArray) -> FloatArray:
    """(3,) the centroid of the border of two parts; without a plane border, the middle of the box of the child."""
    contact = contacts.get((min(child, parent), max(child, parent)))
    plane = contact.plane if contact else None
    middle: FloatArray = boxes[child].mean(axis=0) if plane is None else plane.point
    return middle


def _in_metres(mesh: Mesh, length: float | None) -> tuple[Mesh, float]:
    """The mesh in metres with z up, in the middle above the plane z = 0, and the factor of its lengths."""
    upright = converted(mesh, "meter", "z")
    low, high = upright.bounds
    longest = float((high - low).max())
    scale = length / longest if length and longest > 0 else 1.0
    if not 0 < longest * scale <= LARGEST_LENGTH:
        raise InvalidParameters(
            f"The mesh is {longest:.3g} m long, and a robot is at most {LARGEST_LENGTH:g} m: give a length."
        )
    ground = np.append(0.5 * (low + high)[:2], low[2])
    vertices = np.where(upright.is_used[:, None], (upright.vertices - ground) * scale, 0.0)
    return Mesh(vertices, upright.faces), scale
