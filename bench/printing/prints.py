"""Prints with connectors and filament slots, as PrusaSlicer sees them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from bench.printing.slicer import are_manifold, tools_of, volumes

if TYPE_CHECKING:
    from segcore.hierarchy import Hierarchy
    from segcore.mesh import Mesh
    from segcore.printing.options import PrintOptions


@dataclass(frozen=True, slots=True)
class PrintCheck:
    """What was found of one print."""

    contacts: int
    connectors: int
    objects: int
    manifold: int  # objects, according to PrusaSlicer
    volume_error: float  # of the sum of the volumes in the report, relative to that of PrusaSlicer
    slots: int
    tools: int  # that the G-code changes to, of those of the slots


def check_print(mesh: Mesh, hierarchy: Hierarchy, segments: int, options: PrintOptions, folder: Path) -> PrintCheck:
    """Write a print for PrusaSlicer into a folder, and slice it."""
    from segcore.printing.plan import plan_print
    from segcore.printing.report import print_report
    from segcore.printing.writer import write_print

    plan = plan_print(mesh, hierarchy, segments, options)
    report, path = print_report(plan), folder / "print.3mf"
    with path.open("wb") as target:
        write_print(target, plan)
    slots = len(report["slots"])
    measured = sum(volumes(path))
    flags = are_manifold([path])
    return PrintCheck(
        contacts=len(report["contacts"]),
        connectors=sum(contact["connector"] is not None for contact in report["contacts"]),
        objects=len(report["objects"]),
        manifold=sum(flags),
        volume_error=abs(sum(one["volume"] or 0.0 for one in report["objects"]) / measured - 1.0),
        slots=slots,
        tools=len(tools_of(path, folder, slots) & set(range(slots))),
    )
