"""Speed and memory of the readers and writers, the readers against trimesh on the same files in the same run.

Times are CPU seconds, the least of five runs in their own process after one run on a small file. Memory is the growth
of the peak memory of the process in the first run, divided by the size of the file.

With --base COMMIT, compare with that version of Cleave instead: the least of nine runs of each reader and writer, of
which the two versions take turns.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from bench.checkout import checked_out
from bench.formats.samples import LOOKED_AT, MORE, READ, write_more, write_usual
from bench.formats.versions import compare

_WRITTEN = ("glb", "ply", "obj", "3mf", "zip", "seg", "npy", "json", "cleave")
_RUNS = 9  # of each version
_SMALL = 200  # faces of the file that the first run reads


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--faces", type=int, default=1_000_000, metavar="N", help="faces of the mesh (%(default)s)")
    parser.add_argument("--base", metavar="COMMIT", help="compare with another version, in a checkout with git")


def run(arguments: argparse.Namespace) -> None:
    with tempfile.TemporaryDirectory(prefix="formats-") as name:
        folder = Path(name)
        for stem, faces in (("mesh", arguments.faces), ("small", _SMALL)):
            write_usual(folder, stem, faces)
            if arguments.base is not None:
                write_more(folder, stem, faces)
        if arguments.base is None:
            _print_readers(folder, arguments.faces)
            print()
            _print_writers(folder)
        else:
            with checked_out(arguments.base) as base:
                _print_versions(folder, base, arguments.faces)


def _print_versions(folder: Path, base: Path, faces: int) -> None:
    work = {f"read {title}": f"read {folder / name}" for title, name in (READ | MORE).items()}
    work |= {f"read {title}, with its look": f"look {folder / (READ | MORE)[title]}" for title in LOOKED_AT}
    work |= {f"write .{kind}": f"write {folder / f'mesh.{kind}'}" for kind in _WRITTEN}
    print(f"| {faces} faces | base s | s | ratio |")
    print("|---|---|---|---|")
    for title, times in zip(work, compare(base, list(work.values()), _RUNS), strict=True):
        print(f"| {title} | {times.base:.3f} | {times.here:.3f} | {times.here / times.base:.2f} |", flush=True)


def _print_readers(folder: Path, faces: int) -> None:
    print(f"| {faces} faces | MB | Cleave s | trimesh s | times faster | Cleave memory | trimesh memory |")
    print("|---|---|---|---|---|---|---|")
    for title, name in READ.items():
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
    for kind in _WRITTEN:
        path = folder / f"mesh.{kind}"
        found = _probe("cleave", "write", path)
        print(f"| .{kind} | {path.stat().st_size / 1e6:.0f} | {found['seconds']:.3f} |", flush=True)


def _probe(program: str, action: str, path: Path) -> dict[str, Any]:
    command = [sys.executable, "-m", "bench.formats.probe", program, action, str(path)]
    result: dict[str, Any] = json.loads(subprocess.run(command, capture_output=True, check=True).stdout)
    return result
