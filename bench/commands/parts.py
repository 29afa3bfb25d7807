"""The list of parts: its CPU time by faces, and whether copies are found.

Constructed bodies have known copies among their parts, at several finenesses. In the authored assets of --assets the
parts of their authors are compared with pairs of parts that have equal numbers of vertices at equal distances from
their mean. The meshes of --meshes are cut into their automatic number of parts first.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from typing import TYPE_CHECKING

from bench.assets.dataset import read_assets
from bench.errors import BenchmarkError
from bench.parts.constructed import Case, cases
from bench.parts.copies import grouped, same_vertices

if TYPE_CHECKING:
    from segcore import PartList
    from segcore.arrays import IntArray
    from segcore.mesh import Mesh


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--fineness", type=int, nargs="*", default=[2, 3, 4], metavar="N", help="of the constructed bodies (2 3 4)"
    )
    parser.add_argument(
        "--assets", type=Path, metavar="FOLDER", help="authored assets, with the parts of their authors"
    )
    parser.add_argument(
        "--meshes", type=Path, nargs="+", default=[], metavar="MESH", help="meshes to be cut into parts"
    )


def run(arguments: argparse.Namespace) -> int:
    """Print tables; the status is 1 if copies of a constructed body are wrong."""
    import segcore
    from segcore.shapes import burr

    small = burr(2)
    segcore.parts(small.mesh, small.parts)  # loads the kernels
    results = [_print_constructed(fineness) for fineness in arguments.fineness]
    if arguments.assets is not None:
        _print_assets(arguments.assets)
    if arguments.meshes:
        print("\n| mesh | faces | parts | s | equal (mirrored) | largest residual |\n|---|---|---|---|---|---|")
        for path in arguments.meshes:
            print(_cut_row(path), flush=True)
    return 0 if all(results) else 1


def _timed(mesh: Mesh, labels: IntArray) -> tuple[PartList, float]:
    """Return the list of parts, and the CPU seconds that it takes."""
    import segcore

    start = time.process_time()
    listed = segcore.parts(mesh, labels)
    return listed, time.process_time() - start


def _print_constructed(fineness: int) -> bool:
    print(
        f"\nfineness {fineness}\n\n| body | faces | parts | s | groups | largest residual |\n|---|---|---|---|---|---|"
    )
    results = [_constructed_row(case) for case in cases(fineness)]
    return all(results)


def _constructed_row(case: Case) -> bool:
    """Print a row; return whether the groups are those of the construction."""
    listed, seconds = _timed(case.mesh, case.labels)
    repeats = listed.repeats.groups
    copies = [copy for repeat in repeats for copy in repeat.copies]
    is_right = {frozenset(repeat.parts) for repeat in repeats} == case.groups
    is_right &= sum(copy.is_mirrored for copy in copies) == case.mirrored
    worst = max((copy.relative_residual for copy in copies), default=0.0)
    words = "right" if is_right else f"wrong: {[repeat.parts for repeat in repeats]}"
    faces, parts = len(case.mesh.faces), len(listed.parts)
    print(f"| {case.name} | {faces} | {parts} | {seconds:.2f} | {words} | {worst:.1e} |", flush=True)
    return is_right


def _print_assets(folder: Path) -> None:
    from segcore.partition import partition_of

    rows: dict[str, list[float]] = {}
    for asset in read_assets(folder):
        mesh = asset.read_mesh()
        labels = partition_of(asset.read_parts(len(mesh.faces)) + 1, len(mesh.faces))[0].labels
        listed, seconds = _timed(mesh, labels)
        known, found = same_vertices(mesh, labels), grouped(listed.repeats)
        closed = sum(part.volume is not None for part in listed.parts)
        row = [
            1,
            len(mesh.faces),
            len(listed.parts),
            closed,
            seconds,
            len(known),
            len(known & found),
            len(found - known),
        ]
        rows[asset.collection] = [a + b for a, b in zip(rows.get(asset.collection, [0.0] * len(row)), row, strict=True)]
    print(
        "\n| set | models | faces | parts | closed | s | pairs with equal vertices | of these grouped | other pairs |"
    )
    print("|---|---|---|---|---|---|---|---|---|")
    for name, row in rows.items():
        shown = [f"{value:.1f}" if place == 4 else f"{value:.0f}" for place, value in enumerate(row)]
        print(f"| {name} | {' | '.join(shown)} |", flush=True)


def _cut_row(path: Path) -> str:
    import segcore

    try:
        mesh = segcore.read_mesh(path)
        labels = segcore.segment(mesh).labels()
    except (segcore.CleaveError, OSError) as error:
        raise BenchmarkError(f"{path}: {error}") from error
    listed, seconds = _timed(mesh, labels)
    groups = [
        f"{len(repeat.copies)} ({sum(copy.is_mirrored for copy in repeat.copies)})" for repeat in listed.repeats.groups
    ]
    worst = max((copy.relative_residual for repeat in listed.repeats.groups for copy in repeat.copies), default=0.0)
    shown = ", ".join(groups) or "none"
    return f"| {path.name} | {len(mesh.faces)} | {len(listed.parts)} | {seconds:.2f} | {shown} | {worst:.1e} |"
