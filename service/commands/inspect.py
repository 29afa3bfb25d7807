"""`cleave inspect`: what is in a mesh file."""

import json
from dataclasses import asdict
from pathlib import Path

import segcore
from segcore.report import MeshReport, mesh_report


def inspect_file(path: Path) -> MeshReport:
    """The report of a mesh file.

    Raises
    ------
    CleaveError
        Where the file cannot be used.
    OSError
        Where it cannot be read.
    """
    return mesh_report(segcore.read_mesh(path, appearance=True))


def report_json(report: MeshReport) -> str:
    return json.dumps(asdict(report), indent=2, allow_nan=False)


def describe(name: str, report: MeshReport) -> list[str]:
    """The report as lines for people; what is as it should be is not mentioned."""
    size = " x ".join(f"{high - low:g}" for low, high in zip(report.lower, report.upper, strict=True))
    lines = [
        f"{name}: {report.faces} faces, {report.vertices} vertices"
        + (f", {report.polygons} polygons" if report.polygons != report.faces else ""),
        f"size {size}, area {report.area:g}" + ("" if report.volume is None else f", volume {report.volume:g}"),
        f"{_count(report.components, 'component')}, {'closed' if report.is_closed else 'not closed'}",
    ]
    lines += [f"{_count(number, what)}{why}" for number, what, why in _findings(report) if number]
    if report.groups:
        lines.append(f"{_count(len(report.groups), 'group')}: {', '.join(name or '(none)' for name in report.groups)}")
    return lines


def _findings(report: MeshReport) -> list[tuple[int, str, str]]:
    return [
        (report.border_edges, "border edge", ", with a face on one side only"),
        (report.non_manifold_edges, "non-manifold edge", ", with three faces or more"),
        (report.flipped_faces, "flipped face", ", turned round to agree with the others"),
        (report.duplicate_faces, "duplicate face", ", with the corners of an earlier one"),
        (report.degenerate_faces, "degenerate face", ", with two corners at one place"),
        (report.sliver_faces, "sliver", ", a face without a reliable direction"),
        (report.welded_vertices, "welded vertex", ", at the same place as another one"),
        (report.unused_vertices, "unused vertex", ", which no face has"),
    ]


def _count(number: int, what: str) -> str:
    if number == 1:
        return f"1 {what}"
    return f"{number} {what[:-2]}ices" if what.endswith("vertex") else f"{number} {what}s"
