"""`cleave inspect`: report what a mesh file contains, or list the parts of a segmentation."""

import argparse
import json
from dataclasses import asdict

from segcore.errors import InvalidParameters
from segcore.levels import Fineness
from segcore.report import MeshReport, mesh_report
from service.commands.arguments import add_level
from service.commands.console import say
from service.commands.inputs import add_mesh, input_name, read_input
from service.commands.part_listing import print_parts


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.description = (
        "Report what a mesh file contains: components, borders, and defects that segmentation repairs. With --parts, "
        "list the parts of a .cleave file, or of a mesh, which is segmented first."
    )
    add_mesh(parser)
    parser.add_argument("--json", action="store_true", help="print the report as JSON")
    parser.add_argument(
        "--parts",
        action="store_true",
        help="list the parts instead: area, volume, box, neighbours, and which are copies of each other",
    )
    add_level(parser, "with --parts: the edited parts, else the automatic number")


def run(choices: argparse.Namespace) -> None:
    """Print the report of a mesh file, or its parts.

    Raises
    ------
    CleaveError
        If the file cannot be used, or a level is given without ``--parts``.
    OSError
        If the file cannot be read.
    """
    if choices.parts:
        return print_parts(choices)
    if not Fineness(choices.segments, choices.granularity).is_automatic:
        raise InvalidParameters("A level has parts: add --parts.")
    report = mesh_report(read_input(choices))
    if choices.json:
        say(json.dumps(asdict(report), indent=2, allow_nan=False))
    else:
        say("\n".join(_lines(input_name(choices.mesh), report)))


def _lines(name: str, report: MeshReport) -> list[str]:
    """Format a report for people; defects are listed only if there are any."""
    size = " x ".join(f"{high - low:g}" for low, high in zip(report.lower, report.upper, strict=True))
    lines = [
        f"{name}: {report.faces} faces, {report.vertices} vertices"
        + (f", {report.polygons} polygons" if report.polygons != report.faces else ""),
        f"size {size}{_meaning(report)}, area {report.area:g}"
        + ("" if report.volume is None else f", volume {report.volume:g}"),
        f"{_count(report.components, 'component')}, {'closed' if report.is_closed else 'not closed'}",
    ]
    if report.stitched_edges:
        edges = _count(report.stitched_edges, "border edge")
        lines.append(f"{edges} stitched, across gaps of up to {report.stitched_gap:.3g}")
    lines += [f"{_count(number, what)}, {meaning}" for number, what, meaning in _defects(report) if number]
    if report.structure is not None and report.structure.has_parts:
        lines.append(f"structure: {report.structure.in_words()}")
    if report.groups:
        lines.append(f"{_count(len(report.groups), 'group')}: {', '.join(name or '(none)' for name in report.groups)}")
    return [*lines, *report.notes]


def _meaning(report: MeshReport) -> str:
    """The unit and the axis that points up, as far as they are known, to follow the size."""
    known = [report.unit, f"{report.up} up" if report.up else None]
    return "".join(f" {word}" for word in known if word)


def _defects(report: MeshReport) -> list[tuple[int, str, str]]:
    """Return the number, the name and the meaning of each kind of defect."""
    return [
        (report.border_edges, "border edge", "with a face on one side only"),
        (report.non_manifold_edges, "non-manifold edge", "with three faces or more"),
        (report.flipped_faces, "flipped face", "turned round to agree with the others"),
        (report.duplicate_faces, "duplicate face", "with the corners of an earlier one"),
        (report.degenerate_faces, "degenerate face", "with two corners at one place"),
        (report.sliver_faces, "sliver", "a face without a reliable direction"),
        (report.welded_vertices, "welded vertex", "at the same place as another one"),
        (report.unused_vertices, "unused vertex", "which no face has"),
    ]


def _count(number: int, what: str) -> str:
    if number == 1:
        return f"1 {what}"
    return f"{number} {what[:-2]}ices" if what.endswith("vertex") else f"{number} {what}s"
