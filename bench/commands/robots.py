"""Robots: convex pieces, masses, and whether MuJoCo loads them and they stand still."""

from __future__ import annotations

import argparse
import os
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, get_args

from bench.errors import BenchmarkError
from bench.robots.standing import is_balanced, stand

if TYPE_CHECKING:
    from segcore.robots.plan import RobotPlan

_HEADS = (
    "mesh", "faces", "links", "closed", "pieces", "seconds", "pieces / parts", "parts / whole", "balanced", "contacts",
    "moved", "speed",
)  # fmt: skip


def add_arguments(parser: argparse.ArgumentParser) -> None:
    from segcore.coordinates import Axis
    from segcore.robots.options import CONCAVITY, Collision

    parser.add_argument("meshes", type=Path, nargs="+", metavar="MESH", help="mesh files")
    parser.add_argument("--up", choices=get_args(Axis), help="the axis that points up (that of the file)")
    parser.add_argument("--concavity", type=float, default=CONCAVITY, help="of a piece (%(default)s)")
    parser.add_argument("--collision", choices=get_args(Collision), default="pieces", help="(%(default)s)")


def run(arguments: argparse.Namespace) -> None:
    print(f"| {' | '.join(_HEADS)} |")
    print("|---" * len(_HEADS) + "|")
    for path in arguments.meshes:
        print(f"| {' | '.join(map(str, _row(path, arguments)))} |", flush=True)


def _row(path: Path, arguments: argparse.Namespace) -> Sequence[object]:
    from segcore.errors import CleaveError
    from segcore.io import read_mesh, with_coordinates
    from segcore.method import segment
    from segcore.robots.options import RobotOptions
    from segcore.robots.plan import plan_robot

    try:
        mesh = with_coordinates(read_mesh(path), None, arguments.up)
        hierarchy = segment(mesh)
        start = sum(os.times()[:4])
        plan = plan_robot(
            mesh, hierarchy, None, RobotOptions(collision=arguments.collision, concavity=arguments.concavity)
        )
        seconds = sum(os.times()[:4]) - start  # those of CoACD's process as well
        whole = plan_robot(mesh, hierarchy, 1, RobotOptions(collision="hull"))
    except (CleaveError, OSError) as error:
        raise BenchmarkError(f"{path}: {error}") from error
    with tempfile.TemporaryDirectory(prefix="robots-") as folder:
        found = stand(plan, Path(folder))
    if abs(found.mass / found.urdf_mass - 1) > 1e-6:
        raise BenchmarkError(f"{path}: the URDF has {found.urdf_mass} kg and the MJCF {found.mass} kg.")
    closed = [link for link in plan.links if link.body.is_closed]
    return (
        path.name, len(mesh.faces), len(plan.links), len(closed),
        sum(len(link.body.pieces) for link in plan.links), f"{seconds:.1f}", f"{_covering(plan):.2f}",
        _ratio(plan, whole), "yes" if is_balanced(plan) else "no", found.contacts,
        f"{found.moved:.1e}", f"{found.speed:.0e}",
    )  # fmt: skip


def _ratio(plan: RobotPlan, whole: RobotPlan) -> str:
    """The sum of the volumes of the parts over that of the whole as one part, if that is closed."""
    return f"{_volume(plan) / _volume(whole):.3f}" if whole.links[0].body.is_closed else "-"


def _volume(plan: RobotPlan) -> float:
    return sum(link.body.properties.volume for link in plan.links if link.body.properties)


def _covering(plan: RobotPlan) -> float:
    """The volume of the convex pieces of the closed parts over that of these parts."""
    from segcore.robots.masses import mass_properties

    closed = [link.body for link in plan.links if link.body.is_closed]
    found = [mass_properties([piece], 1.0) for body in closed for piece in body.pieces]
    return sum(one.volume for one in found if one) / sum(body.properties.volume for body in closed if body.properties)
