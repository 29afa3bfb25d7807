"""The plan of a print: the parts of a segmented mesh as solids in millimetres, with connectors."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from segcore.arrays import FloatArray, IntArray
from segcore.clean.surface import build_surface
from segcore.coordinates import Unit
from segcore.errors import InvalidParameters
from segcore.hierarchy import Hierarchy
from segcore.io.converting import converted
from segcore.io.names import SegmentNames, segment_names
from segcore.io.palette import SegmentColors
from segcore.io.parts.pieces import closed_groups, labels_on, positions
from segcore.mesh import Mesh
from segcore.printing.beds import Divided, divide, room_for
from segcore.printing.booleans import solid_of, surface_of
from segcore.printing.connectors import Joint, add_connectors
from segcore.printing.contacts import Closed, find_contacts
from segcore.printing.fitting import FittedLevel, fitted_level
from segcore.printing.options import LARGEST_LENGTH, PrintOptions
from segcore.printing.slots import Slot, slots_of

if TYPE_CHECKING:
    from manifold3d import Manifold


@dataclass(frozen=True, slots=True, eq=False)
class Piece:
    """An object of the print: a part, a piece of one, or a dowel. Lengths in mm."""

    name: str
    vertices: FloatArray  # (V, 3)
    faces: IntArray  # (F, 3)
    volume: float | None  # None if it is not a closed solid
    label: int | None  # the part that it is or belongs to; None for a dowel
    slot: int  # the number of its filament, from 1

    @property
    def size(self) -> FloatArray:
        """(3,) the sides of its box."""
        size: FloatArray = np.ptp(self.vertices, axis=0)
        return size


@dataclass(frozen=True, slots=True, eq=False)
class PrintPlan:
    """What is written and reported."""

    options: PrintOptions
    unit: Unit | None  # of the mesh; None if it is not known and taken as mm
    scale: float  # that was applied to lengths in mm
    closed_volumes: Mapping[int, float]  # mm^3 of the pieces of the level before connectors are added
    pieces: list[Piece]
    slots: list[Slot]
    joints: list[Joint]  # between pieces of the level
    cuts: Mapping[int, list[Joint]]  # where planes divide a piece of the level, by its number
    level: FittedLevel


def plan_print(
    mesh: Mesh,
    hierarchy: Hierarchy,
    segments: int | None = None,
    options: PrintOptions | None = None,
    *,
    names: SegmentNames | None = None,
    part_colors: SegmentColors | None = None,
) -> PrintPlan:
    """Return the parts of a level as solids with connectors, in millimetres with z up, the lowest corner at 0.

    A mesh whose unit is not known is taken as it is in millimetres. Parts that are no closed solids get no connectors
    and are not divided.

    Parameters
    ----------
    names, part_colors : of segments by label, in place of ``segment k`` and of the fixed colours.

    Raises
    ------
    InvalidParameters
        If ``segments`` is not in 1..max_segments, no part has faces, or the whole is too large to be printed.
    MissingPackage
        If manifold3d is not installed.
    """
    options = options or PrintOptions()
    count = len(hierarchy.segment_nodes(segments))
    moved, scale = _in_millimetres(mesh, options.size)
    level = fitted_level(hierarchy, segments, moved.corners, room_for(options))
    surface = build_surface(moved)
    vertices, labels = positions(moved, surface), labels_on(surface, level.labels)
    parts = _closed(vertices, surface.faces, labels, len(level.part))
    solids = {piece: solid for piece, part in parts.items() if (solid := solid_of(part.vertices, part.faces))}
    volumes = {piece: solid.volume() for piece, solid in solids.items()}
    joints = add_connectors(solids, find_contacts(vertices, surface.faces, labels, parts), options)
    divided = {piece: divide(solid, options) for piece, solid in solids.items()}
    cuts = {piece: one.joints for piece, one in divided.items()}
    present = sorted({level.part[piece] for piece in parts})
    slots = slots_of(present, _by_part(volumes, level), count, options.slots, part_colors)
    slot = {label: one.number for one in slots for label in one.labels}
    titles = segment_names(names, count)
    pieces = [
        piece
        for number, part in sorted(parts.items())
        for piece in _pieces(part, divided.get(number), level, titles, slot)
    ]
    pieces += _dowels(joints, cuts, [slot[label] for label in level.part])
    return PrintPlan(options, mesh.coordinates.unit, scale, volumes, pieces, slots, joints, cuts, level)


def _in_millimetres(mesh: Mesh, size: float | None) -> tuple[Mesh, float]:
    """The mesh in mm with z up, its lowest corner at 0, and the factor of its lengths."""
    upright = converted(mesh, "millimeter", "z")
    low, high = upright.bounds
    longest = float((high - low).max())
    scale = size / longest if size and longest > 0 else 1.0
    if not 0 < longest * scale <= LARGEST_LENGTH:
        raise InvalidParameters(
            f"The mesh is {longest:.3g} mm long, and a print is at most {LARGEST_LENGTH:g} mm: give a size."
        )
    moved = np.where(upright.is_used[:, None], (upright.vertices - low) * scale, 0.0)
    return Mesh(moved, upright.faces), scale


def _closed(vertices: FloatArray, faces: IntArray, labels: IntArray, count: int) -> dict[int, Closed]:
    a, b, c = faces.T
    own = np.bincount(labels[(a != b) & (b != c) & (c != a)], minlength=count)
    parts = {
        part.label: Closed(part.label, part.vertices, part.faces, int(own[part.label]))
        for part in closed_groups(vertices, faces, labels, count)
    }
    if not parts:
        raise InvalidParameters("The mesh has no face with an area, so that there is nothing to print.")
    return parts


def _by_part(volumes: Mapping[int, float], level: FittedLevel) -> dict[int, float]:
    total = dict.fromkeys(level.part, 0.0)
    for piece, volume in volumes.items():
        total[level.part[piece]] += volume
    return total


def _pieces(
    part: Closed, divided: Divided | None, level: FittedLevel, titles: Sequence[str], slot: Mapping[int, int]
) -> Iterator[Piece]:
    """Yield what a piece of the level becomes: itself, or several that planes have divided."""
    label = level.part[part.label]
    title = titles[label]
    if level.part.count(label) > 1:
        title += f" {level.number(part.label)}"
    if divided is None:
        yield Piece(title, part.vertices, part.faces, None, label, slot[label])
        return
    for k, solid in enumerate(divided.pieces):
        yield _piece(f"{title} {k + 1}" if len(divided.pieces) > 1 else title, solid, label, slot[label])


def _piece(name: str, solid: Manifold, label: int | None, slot: int) -> Piece:
    vertices, faces = surface_of(solid)
    return Piece(name, vertices, faces, solid.volume(), label, slot)


def _dowels(joints: list[Joint], cuts: Mapping[int, list[Joint]], slot: Sequence[int]) -> Iterator[Piece]:
    """Yield the dowels, each of the filament of the first piece that it joins; ``slot`` is that of every piece."""
    own = [(joint, joint.contact.parts[0]) for joint in joints]
    own += [(joint, piece) for piece, of_piece in cuts.items() for joint in of_piece]
    dowels = [(joint.connector.dowel, piece) for joint, piece in own if joint.connector and joint.connector.dowel]
    for k, (dowel, piece) in enumerate(dowels):
        yield _piece(f"dowel {k + 1}", dowel, None, slot[piece])
