"""Solids that are larger than the bed, divided by planes, with connectors between the pieces."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from segcore.arrays import FloatArray, plane_axes
from segcore.printing.booleans import region, surface_of
from segcore.printing.circles import largest_circle
from segcore.printing.connectors import LARGEST_DEPTH, Joint, add_connectors
from segcore.printing.contacts import Contact
from segcore.printing.options import PrintOptions

if TYPE_CHECKING:
    from manifold3d import Manifold

_MOST_PIECES = 64  # of one part; set by hand
_ON_PLANE = 1e-6  # mm


@dataclass(frozen=True, slots=True, eq=False)
class Divided:
    """The pieces of a part, and the contacts between them; the parts of a contact are numbers of pieces, from 0."""

    pieces: list[Manifold]
    joints: list[Joint]


@dataclass(frozen=True, slots=True)
class _Plane:
    axis: int
    place: float


def room_for(options: PrintOptions) -> FloatArray:
    """(3,) the sides of the largest piece that fits the bed with the pegs that it may get on both sides."""
    added = LARGEST_DEPTH + options.clearance if options.connectors == "peg" else 0.0
    room: FloatArray = np.array(options.sides) - 2 * added
    return room


def divide(solid: Manifold, options: PrintOptions) -> Divided:
    """Halve the sides of a part that are larger than the bed, by planes across them, until every piece fits.

    A half that consists of several bodies becomes a piece for each. A part that would need more than 64 pieces is
    divided into about so many, which are larger than the bed.
    """
    if options.bed is None:
        return Divided([solid], [])
    room = room_for(options)
    pieces: list[Manifold] = []
    planes: list[_Plane] = []
    waiting = [solid]
    while waiting:
        piece = waiting.pop(0)
        plane = _middle_plane(piece, room)
        if plane is None or len(pieces) + len(waiting) + 1 >= _MOST_PIECES:
            pieces.append(piece)
            continue
        planes.append(plane)
        halves = piece.split_by_plane(np.eye(3)[plane.axis], plane.place)
        waiting += [body for half in halves for body in half.decompose()]
    solids = dict(enumerate(pieces))
    joints = add_connectors(solids, _contacts(pieces, planes), options)
    return Divided([solids[k] for k in range(len(pieces))], joints)


def _middle_plane(piece: Manifold, room: FloatArray) -> _Plane | None:
    """The plane that halves the side that exceeds the room most; None if the piece fits."""
    low, high = np.array(piece.bounding_box()).reshape(2, 3)
    excess = (high - low) / room
    axis = int(excess.argmax())
    return _Plane(axis, float(0.5 * (low + high)[axis])) if excess[axis] > 1 else None


def _contacts(pieces: list[Manifold], planes: list[_Plane]) -> list[Contact]:
    """The regions that two pieces have in common in the planes."""
    corners = [vertices[faces] for vertices, faces in map(surface_of, pieces)]
    found: list[Contact] = []
    for plane in dict.fromkeys(planes):
        normal = np.eye(3)[plane.axis]
        caps = [part[(np.abs(part @ normal - plane.place) <= _ON_PLANE).all(axis=1)] for part in corners]
        touching = [k for k, cap in enumerate(caps) if len(cap)]
        for one, other in combinations(touching, 2):
            found += _common_regions((one, other), caps[one], caps[other], normal * plane.place)
    return found


def _common_regions(pair: tuple[int, int], one: FloatArray, other: FloatArray, origin: FloatArray) -> list[Contact]:
    towards, against = _area_vector(one), _area_vector(other)
    if towards @ against >= 0:
        return []  # they are not on different sides of the plane
    normal = towards / np.linalg.norm(towards)
    frame = plane_axes(normal)
    common = region((one - origin) @ frame.T) ^ region((other - origin) @ frame.T)
    circles = [(part.area(), largest_circle(part)) for part in common.decompose()]
    return [
        Contact(pair, origin + circle.centre @ frame, normal, area, circle.radius, 0.0)
        for area, circle in circles
        if circle is not None
    ]


def _area_vector(triangles: FloatArray) -> FloatArray:
    """(3,) twice the sum of the areas of triangles (N, 3, 3) along their normals."""
    vector: FloatArray = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]).sum(axis=0)
    return vector
