"""Output files of the commands: their arguments, and files that are written completely or not at all."""

import argparse
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import BinaryIO

from segcore.hierarchy import Hierarchy
from segcore.io.writing import WRITERS, writer_for
from segcore.mesh import Mesh
from worker.jobs.objects.durable import replace_file

_EXTENSIONS = [writer.extension for writer in WRITERS.values()]


def add_outputs(parser: argparse.ArgumentParser, required: bool = False) -> None:
    """Add ``--output`` and the options of the formats, which :func:`output_options` reads."""
    parser.add_argument(
        "-o",
        "--output",
        type=_output,
        action="append",
        required=required,
        default=None if required else [],
        metavar="FILE",
        help=f"output file, in the format of its extension: {' '.join(_EXTENSIONS)}; can be repeated",
    )
    parser.add_argument("--all-levels", action="store_true", help="GLB: every number of segments in one file")
    parser.add_argument(
        "--features", action="store_true", help="GLB: the hierarchy as EXT_structural_metadata, with EXT_mesh_features"
    )
    parser.add_argument(
        "--output-unit", metavar="UNIT", help="OBJ, PLY and ZIP: convert the coordinates to this unit, such as mm"
    )
    parser.add_argument("--output-up", metavar="AXIS", help="OBJ, PLY and ZIP: turn the mesh so that y or z points up")
    parser.add_argument("--capped", action="store_true", help="3MF and ZIP: close every part, for printing")
    parser.add_argument("--parts", choices=("stl", "obj"), default="stl", help="ZIP: format of its files (%(default)s)")


def output_options(choices: argparse.Namespace) -> dict[str, object]:
    """Return the options that were given, by their names in ``Writer.options``."""
    return {
        "all_levels": choices.all_levels,
        "features": choices.features,
        "capped": choices.capped,
        "unit": choices.output_unit,
        "up": choices.output_up,
        "part_format": choices.parts,
    }


def check_outputs(paths: Sequence[Path]) -> None:
    """Check the folders of the outputs before a long computation.

    Raises
    ------
    NotADirectoryError
        If a folder does not exist.
    """
    for path in paths:
        if not path.parent.is_dir():
            raise NotADirectoryError(20, "There is no such folder", str(path.parent))


def write_model(path: Path, mesh: Mesh, hierarchy: Hierarchy, segments: int | None, options: dict[str, object]) -> None:
    """Write a segmented mesh in the format of the extension, with those of the options that the format has.

    Raises
    ------
    UnsupportedFormat, InvalidParameters, OSError
    """
    writer = writer_for(path.name)
    chosen = {name: value for name, value in options.items() if name in writer.options}
    write_file(path, lambda target: writer.write(target, mesh, hierarchy, segments, **chosen))


def write_file(path: Path, write: Callable[[BinaryIO], object]) -> None:
    """Write a file completely or not at all; anything but a regular file, such as a pipe, is written directly."""
    if path.exists() and not path.is_file():
        with path.open("wb") as target:
            write(target)
    else:
        replace_file(path.resolve(), write)


def _output(text: str) -> Path:
    if Path(text).suffix.lower() not in _EXTENSIONS:
        raise argparse.ArgumentTypeError(f"{text!r} must end in one of {' '.join(_EXTENSIONS)}")
    return Path(text)
