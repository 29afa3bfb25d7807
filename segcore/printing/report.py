"""The report of a print, as a JSON value."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from segcore.arrays import significant
from segcore.printing.connectors import Joint
from segcore.printing.plan import Piece, PrintPlan


def print_report(plan: PrintPlan) -> dict[str, Any]:
    """Return what is printed: objects, filaments, and contacts with their connector or the reason for none.

    Lengths are in mm, areas in mm^2, volumes in mm^3. ``objects`` are in the order of the 3MF file. Contacts between
    pieces of one part have ``pieces``, the numbers in the names of the objects.
    """
    options = plan.options
    return {
        "unit_of_mesh": plan.unit,
        "scale": plan.scale,
        "connectors": options.connectors,
        "clearance": options.clearance,
        "bed": None if options.bed is None else list(options.sides),
        "volume": significant(sum(plan.closed_volumes.values())),
        "objects": [_object(plan, piece) for piece in plan.pieces],
        "slots": [{"slot": one.number, "color": one.color, "parts": list(one.labels)} for one in plan.slots],
        "contacts": [*_joints(plan), *_cuts(plan)],
    }


def _object(plan: PrintPlan, piece: Piece) -> dict[str, Any]:
    return {
        "name": piece.name,
        "part": piece.label,
        "slot": piece.slot,
        "closed": piece.volume is not None,
        "volume": None if piece.volume is None else significant(piece.volume),
        "size": [significant(side) for side in piece.size],
        "fits_bed": bool((piece.size <= np.array(plan.options.sides)).all()),
    }


def _joints(plan: PrintPlan) -> Iterator[dict[str, Any]]:
    """Yield the contacts between pieces of the level."""
    level = plan.level
    for joint in plan.joints:
        parts = [level.part[piece] for piece in joint.contact.parts]
        pieces = [level.number(piece) for piece in joint.contact.parts] if parts[0] == parts[1] else None
        yield {"parts": parts, "pieces": pieces, **_contact(joint, plan.options.connectors)}


def _cuts(plan: PrintPlan) -> Iterator[dict[str, Any]]:
    """Yield the contacts at planes."""
    for piece, joints in plan.cuts.items():
        for joint in joints:
            pieces = [number + 1 for number in joint.contact.parts]
            yield {"parts": [plan.level.part[piece]] * 2, "pieces": pieces, **_contact(joint, plan.options.connectors)}


def _contact(joint: Joint, kind: str) -> dict[str, Any]:
    contact, connector = joint.contact, joint.connector
    return {
        "area": significant(contact.area),
        "circle_diameter": significant(2 * contact.radius),
        "deviation": significant(contact.deviation),
        "connector": connector
        and {
            "kind": kind,
            "diameter": significant(2 * connector.radius),
            "hole_diameter": significant(2 * connector.hole_radius),
            "depth": significant(connector.depth),
            "hole_depth": significant(connector.hole_depth),
            "holes": len(connector.holes),
            "centre": [significant(value) for value in contact.centre],
        },
        "reason": joint.reason,
    }
