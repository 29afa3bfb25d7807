"""Speed and memory of the readers and writers, the readers against trimesh on the same files in the same run.

Times are CPU seconds, the least of five runs in their own process after one run on a small file. Memory is the growth
of the peak memory of the process in the first run, divided by the size of the file.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

_FILES = {
    "PLY, binary": "mesh.ply",
    "GLB": "mesh.glb",
    "STL, binary": "mesh.stl",
    "OFF": "mesh.off",
    "OBJ": "mesh.obj",
}
_WRITTEN: tuple[tuple[str, dict[str, object]], ...] = (
    ("glb", {}),
    ("ply", {}),
    ("obj", {}),
    ("3mf", {}),
    ("3mf", {"capped": False}),
    ("zip", {}),
    ("zip", {"capped": False}),
    ("seg", {}),
    ("npy", {}),
    ("json", {}),
    ("cleave", {}),
)
_SMALL = 200  # faces of the file that the first run reads


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--faces", type=int, default=1_000_000, metavar="N", help="faces of the mesh (%(default)s)")


def run(arguments: argparse.Namespace) -> None:
    with tempfile.TemporaryDirectory(prefix="formats-") as name:
        folder = Path(name)
        for stem, faces in (("mesh", arguments.faces), ("small", _SMALL)):
            _export(folder, stem, faces)
        _print_readers(folder, arguments.faces)
        print()
        _print_writers(folder)


def _export(folder: Path, stem: str, faces: int) -> None:
    import trimesh

    from bench.formats.probe import torus

    mesh = trimesh.Trimesh(*torus(faces), process=False)
    for name in _FILES.values():
        mesh.export(folder / Path(name).with_stem(stem))


def _print_readers(folder: Path, faces: int) -> None:
    print(f"| {faces} faces | MB | Cleave s | trimesh s | times faster | Cleave memory | trimesh memory |")
    print("|---|---|---|---|---|---|---|")
    for title, name in _FILES.items():
        path = folder / name
        ours, theirs = (_probe(program, "read", path) for program in ("cleave", "trimesh"))
        size = path.stat().st_size
        print(
            f"| {title} | {size / 1e6:.0f} | {ours['seconds']:.3f} | {theirs['seconds']:.3f} "
            f"| {theirs['seconds'] / ours['seconds']:.1f} | {ours['peak'] / size:.1f} | {theirs['peak'] / size:.1f} |",
            flush=True,
        )


def _print_writers(folder: Path) -> None:
    print("| written | MB | Cleave s |")
    print("|---|---|---|")
    for kind, options in _WRITTEN:
        path = folder / f"mesh.{kind}"
        found = _probe("cleave", "write", path, json.dumps(options))
        title = f".{kind}, open parts" if options else f".{kind}"
        print(f"| {title} | {path.stat().st_size / 1e6:.0f} | {found['seconds']:.3f} |", flush=True)


def _probe(program: str, action: str, path: Path, *options: str) -> dict[str, Any]:
    command = [sys.executable, "-m", "bench.formats.probe", program, action, str(path), *options]
    result: dict[str, Any] = json.loads(subprocess.run(command, capture_output=True, check=True).stdout)
    return result
