"""The options of `cleave convert --robot`, and the file that they ask for."""

import argparse
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, get_args

from segcore.errors import InvalidParameters
from segcore.robots.options import CONCAVITY, DENSITY, MOST_PIECES, Collision, Joints, RobotOptions
from service.commands.outputs import edited_parts, write_file

if TYPE_CHECKING:
    from segcore.io import Segmentation

_OPTIONS = ("joints", "collision", "concavity", "pieces", "density", "length")


def add_robot_options(parser: argparse.ArgumentParser) -> None:
    """Add ``--robot`` and the options of robots, which :func:`robot_options` reads."""
    group = parser.add_argument_group("simulation")
    group.add_argument(
        "--robot",
        action="store_true",
        help="write URDF and MJCF in a ZIP archive: parts as links with masses, in metres; needs cleave-mesh[robot]",
    )
    group.add_argument("--joints", choices=get_args(Joints), help="fixed, or hinges at plane borders (fixed)")
    group.add_argument(
        "--collision", choices=get_args(Collision), help="convex pieces of parts, or their convex hulls (pieces)"
    )
    group.add_argument(
        "--concavity", type=float, metavar="C", help=f"of a piece, from 0.01 to 1: smaller for more ({CONCAVITY})"
    )
    group.add_argument("--pieces", type=int, metavar="N", help=f"largest number of pieces of a part ({MOST_PIECES})")
    group.add_argument("--density", type=float, metavar="KG/M3", help=f"of all parts ({DENSITY:g})")
    group.add_argument("--length", type=float, metavar="M", help="longest side of the whole (that of the mesh)")


def robot_options(choices: argparse.Namespace) -> RobotOptions | None:
    """Return the options; None if no robot is to be written.

    Raises
    ------
    InvalidParameters
        If a value is out of range, an option is given without ``--robot``, or an output is no ZIP archive.
    """
    given: dict[str, Any] = {name: getattr(choices, name) for name in _OPTIONS if getattr(choices, name) is not None}
    if not choices.robot:
        if given:
            raise InvalidParameters(f"--{next(iter(given))} is an option of --robot: add --robot.")
        return None
    if choices.prints:
        raise InvalidParameters("A print and a robot are different files: give --print or --robot.")
    if any(path.suffix.lower() != ".zip" for path in choices.output):
        raise InvalidParameters("A robot is written as a ZIP archive: give an output that ends in .zip.")
    return RobotOptions(**given)


def write_robots(
    choices: argparse.Namespace, result: "Segmentation", segments: int, options: RobotOptions
) -> list[str]:
    """Write the edited parts, or a level if there are none, as a robot; return lines about it.

    Raises
    ------
    CleaveError, OSError
    """
    from segcore.robots.plan import plan_robot
    from segcore.robots.report import robot_report
    from segcore.robots.writer import write_robot

    if result.edited is None:
        plan = plan_robot(result.mesh, result.hierarchy, segments, options)
    else:
        hierarchy, looks = edited_parts(result.mesh, result.edited)
        plan = plan_robot(result.mesh, hierarchy, None, options, **looks)
    for path in choices.output:
        write_file(path, lambda target: write_robot(target, plan))
    return list(_lines(robot_report(plan), has_length=options.length is not None))


def _lines(report: dict[str, Any], *, has_length: bool) -> Iterator[str]:
    if report["unit_of_mesh"] is None and not has_length:
        yield "the unit of the mesh is not known: its lengths are taken as metres (--unit or --length changes that)"
    links = report["links"]
    hinges = sum(link["joint"] == "hinge" for link in links)
    pieces = sum(link["collision_pieces"] for link in links)
    yield f"{len(links)} links, {hinges} hinges, {pieces} convex pieces, {report['mass']:g} kg"
    for link in links:
        if link["why_fixed"]:
            yield f"{link['name']} is fixed: {link['why_fixed']}"
        if link["note"]:
            yield f"{link['name']}: {link['note'][0].lower()}{link['note'][1:]}"
