"""Real mesh files: the number of faces and the area against trimesh, and the corners of glTF files against three.js.

Every file in the folder given with --data, or below it, that has the extension of a mesh is read by both readers, each
in a process of its own with limits of time and memory. The areas must be equal to a relative 1e-6. An area that differs
because concave polygons are not fans is counted as such if the fans have the area of trimesh. All other differences and
refusals are listed with their reasons. Files with other content than their name says are refused by both or listed.

With --three NODE_MODULES, the positions of all triangles of glTF and GLB files are compared with those of the
GLTFLoader of three.js, one by one in the order of the file: in the pose of the file, with skins, morph targets and
copies. The folder is node_modules of the packages three and draco3d.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

from bench.errors import BenchmarkError
from bench.files.comparison import VERDICTS, Comparison, compare
from bench.files.three import Three
from bench.guarded import Guarded
from bench.text import format_table

_GLTF = (".glb", ".gltf")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--data", type=Path, required=True, metavar="DIR", help="a folder with mesh files")
    parser.add_argument("--three", type=Path, metavar="NODE_MODULES", help="compare glTF files with three.js")


def run(arguments: argparse.Namespace) -> None:
    files = mesh_files(arguments.data)
    if not files:
        raise BenchmarkError(f"There is no mesh file in {arguments.data}.")
    if arguments.three is None:
        found = list(with_trimesh(files))
    else:
        found = list(with_three([path for path in files if path.suffix.lower() in _GLTF], arguments.three))
    print(render(found, arguments.data))


def mesh_files(folder: Path) -> list[Path]:
    """Return all files in a folder and below it that have the extension of a mesh."""
    from segcore.io.file_sets import is_mesh_name

    return sorted(path for path in folder.rglob("*") if path.is_file() and is_mesh_name(str(path.relative_to(folder))))


def with_trimesh(files: list[Path]) -> Iterator[Comparison]:
    """Read every file by both readers."""
    with ExitStack() as stack:
        ours, theirs = (
            stack.enter_context(Guarded([sys.executable, "-m", "bench.files.reading", name]))
            for name in ("cleave", "trimesh")
        )
        for path in files:
            yield compare(path, ours.ask(str(path)), theirs.ask(str(path)))


def with_three(files: list[Path], modules: Path) -> Iterator[Comparison]:
    """Read every file by Cleave and by three.js.

    Raises
    ------
    BenchmarkError
        If the folder does not have three.
    """
    if not (modules / "three").is_dir():
        raise BenchmarkError(f"{modules} does not have the package three: run npm install three draco3d.")
    with tempfile.TemporaryDirectory(prefix="files-") as folder, Three(modules, Path(folder)) as three:
        for path in files:
            yield three.compare(path)


def render(found: list[Comparison], folder: Path) -> str:
    """Return the counts by extension, then a line for each file that differs or that one or both refuse."""
    kinds = sorted({comparison.path.suffix.lower() for comparison in found})
    counts = Counter((comparison.path.suffix.lower(), comparison.verdict) for comparison in found)
    rows = [[kind, *(str(counts[kind, verdict]) for verdict in VERDICTS)] for kind in kinds]
    rows.append(["all", *(str(sum(counts[kind, verdict] for kind in kinds)) for verdict in VERDICTS)])
    lines = [
        f"{comparison.verdict}: {comparison.path.relative_to(folder)}: {comparison.reason}".rstrip(": ")
        for comparison in sorted(found, key=lambda one: (VERDICTS.index(one.verdict), one.path))
        if comparison.verdict != "equal"
    ]
    return "\n".join([format_table(["files", *VERDICTS], rows, [len(rows) - 1]), "", *lines])
