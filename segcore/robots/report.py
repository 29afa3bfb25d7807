"""The report of a robot, as a JSON value."""

from collections.abc import Iterable
from typing import Any

import numpy as np

from segcore.arrays import significant
from segcore.robots.plan import Link, RobotPlan

_DECIMALS = 12  # of coordinates, so that rounding errors are not shown


def robot_report(plan: RobotPlan) -> dict[str, Any]:
    """Return the links with their masses and joints, in the order of the files.

    Lengths are in m, volumes in m^3, masses in kg, in coordinates whose origin is below the middle of the whole.
    """
    options = plan.options
    found = [link.body.properties for link in plan.links]
    return {
        "unit_of_mesh": plan.unit,
        "scale": plan.scale,
        "density": options.density,
        "joints": options.joints,
        "collision": options.collision,
        "mass": significant(sum(one.mass for one in found if one)),
        "volume": significant(sum(one.volume for one in found if one)),
        "links": [_link(plan, link) for link in plan.links],
    }


def _link(plan: RobotPlan, link: Link) -> dict[str, Any]:
    joint, properties, ground = link.joint, link.body.properties, plan.links[0].origin
    return {
        "link": link.name,
        "part": link.label,
        "name": link.title,
        "parent": joint and plan.links[joint.parent].name,
        "joint": joint and joint.kind,
        "origin": _coordinates(link.origin - ground),
        "axis": None if joint is None or joint.axis is None else _coordinates(joint.axis),
        "why_fixed": joint and joint.reason,
        "mass": properties and significant(properties.mass),
        "volume": properties and significant(properties.volume),
        "centre_of_mass": properties and _coordinates(properties.centre - ground),
        "closed": link.body.is_closed,
        "collision_pieces": len(link.body.pieces),
        "note": link.body.note,
    }


def _coordinates(values: Iterable[float]) -> list[float]:
    return [significant(value) + 0.0 for value in np.round(np.asarray(values), _DECIMALS)]  # no -0.0
