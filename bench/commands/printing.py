"""Parts for printing: whether PrusaSlicer takes every object of 3MF files and every STL file for manifold."""

from __future__ import annotations

import argparse
import tempfile
import zipfile
from pathlib import Path
from typing import TYPE_CHECKING

from bench.errors import BenchmarkError
from bench.printing.slicer import are_manifold

if TYPE_CHECKING:
    from segcore.hierarchy import Hierarchy
    from segcore.mesh import Mesh


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("meshes", type=Path, nargs="+", metavar="MESH", help="mesh files")
    parser.add_argument("--segments", type=int, metavar="K", help="number of segments (the automatic one)")


def run(arguments: argparse.Namespace) -> None:
    print("| mesh | faces | parts | 3MF manifold | STL manifold |")
    print("|---|---|---|---|---|")
    for path in arguments.meshes:
        print(_row(path, arguments.segments), flush=True)


def _row(path: Path, segments: int | None) -> str:
    from segcore.errors import CleaveError
    from segcore.io import read_mesh
    from segcore.method import segment

    try:
        mesh = read_mesh(path)
        hierarchy = segment(mesh)
        count = segments or hierarchy.automatic_segments
        found = _manifold(mesh, hierarchy, count)
    except (CleaveError, OSError) as error:
        raise BenchmarkError(f"{path}: {error}") from error
    return f"| {path.name} | {len(mesh.faces)} | {count} | {found['3mf']} | {found['stl']} |"


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
