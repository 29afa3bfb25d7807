"""Parts for printing: whether PrusaSlicer takes every object for manifold, and slices prints with connectors."""

from __future__ import annotations

import argparse
import tempfile
import zipfile
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from bench.errors import BenchmarkError
from bench.printing.prints import check_print
from bench.printing.slicer import are_manifold

if TYPE_CHECKING:
    from segcore.hierarchy import Hierarchy
    from segcore.mesh import Mesh


_HEADS = ("mesh", "faces", "parts", "3MF manifold", "STL manifold")
_PRINT_HEADS = ("mesh", "faces", "parts", "connectors", "manifold", "volume error", "tools")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("meshes", type=Path, nargs="+", metavar="MESH", help="mesh files")
    parser.add_argument("--segments", type=int, metavar="K", help="number of segments (the automatic one)")
    parser.add_argument("--connectors", choices=("dowel", "peg"), help="write prints, and slice them (plain files)")
    parser.add_argument("--size", type=float, default=100.0, help="of prints, in mm (%(default)s)")
    parser.add_argument("--slots", type=int, default=4, help="filaments of prints (%(default)s)")


def run(arguments: argparse.Namespace) -> None:
    heads = _PRINT_HEADS if arguments.connectors else _HEADS
    print(f"| {' | '.join(heads)} |")
    print("|---" * len(heads) + "|")
    for path in arguments.meshes:
        print(f"| {' | '.join(map(str, _row(path, arguments)))} |", flush=True)


def _row(path: Path, arguments: argparse.Namespace) -> Sequence[object]:
    from segcore.errors import CleaveError
    from segcore.io import read_mesh
    from segcore.method import segment

    try:
        mesh = read_mesh(path)
        hierarchy = segment(mesh)
        count = arguments.segments or hierarchy.automatic_segments
        cells = _print_cells if arguments.connectors else _plain_cells
        return path.name, len(mesh.faces), count, *cells(mesh, hierarchy, count, arguments)
    except (CleaveError, OSError) as error:
        raise BenchmarkError(f"{path}: {error}") from error


def _plain_cells(mesh: Mesh, hierarchy: Hierarchy, count: int, _: argparse.Namespace) -> Sequence[object]:
    found = _manifold(mesh, hierarchy, count)
    return found["3mf"], found["stl"]


def _print_cells(mesh: Mesh, hierarchy: Hierarchy, count: int, arguments: argparse.Namespace) -> Sequence[object]:
    from segcore.printing.options import PrintOptions

    options = PrintOptions(connectors=arguments.connectors, size=arguments.size, slots=arguments.slots, slicer="prusa")
    with tempfile.TemporaryDirectory(prefix="printing-") as name:
        found = check_print(mesh, hierarchy, count, options, Path(name))
    return (
        f"{found.connectors} of {found.contacts}",
        f"{found.manifold} of {found.objects}",
        f"{found.volume_error:.0e}",
        f"{found.tools} of {found.slots}",
    )


def _manifold(mesh: Mesh, hierarchy: Hierarchy, segments: int) -> dict[str, str]:
    """Return how many objects are manifold, of how many, in a 3MF file and in the archive of parts as STL."""
    from segcore.io import write_3mf, write_parts

    with tempfile.TemporaryDirectory(prefix="printing-") as name:
        folder = Path(name)
        with (folder / "model.3mf").open("wb") as target:
            write_3mf(target, mesh, hierarchy, segments)
        with (folder / "parts.zip").open("wb") as target:
            write_parts(target, mesh, hierarchy, segments)
        with zipfile.ZipFile(folder / "parts.zip") as archive:
            archive.extractall(folder)
        files = {"3mf": [folder / "model.3mf"], "stl": sorted(folder.glob("*.stl"))}
        found = {kind: are_manifold(paths) for kind, paths in files.items()}
    return {kind: f"{sum(flags)} of {len(flags)}" for kind, flags in found.items()}
