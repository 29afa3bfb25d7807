"""Output files of the commands: their arguments, and files that are written completely or not at all."""

import argparse
import io
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, get_args

from segcore.errors import InvalidParameters
from segcore.hierarchy import Hierarchy
from segcore.io.formats import Layout, PartFormat, PlyColors
from segcore.io.writing import WRITERS, Writer, writer_for
from segcore.mesh import Mesh
from service.commands.console import forget_output, say, say_beside
from service.commands.inputs import STANDARD
from worker.jobs.objects.durable import replace_file

if TYPE_CHECKING:
    from segcore.io import Edited, Original, Segmentation

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
        help=f"output file, in the format of its extension: {' '.join(_EXTENSIONS)}; can be repeated; - for the "
        "standard output, with --to",
    )
    parser.add_argument("--to", choices=list(WRITERS), metavar="FORMAT", help="the format of -o -, such as glb")
    parser.add_argument("--all-levels", action="store_true", help="GLB: every number of segments in one file")
    parser.add_argument(
        "--features", action="store_true", help="GLB: the hierarchy as EXT_structural_metadata, with EXT_mesh_features"
    )
    parser.add_argument(
        "--layout",
        choices=get_args(Layout),
        default="tree",
        help="GLB: nodes nested as the hierarchy, or all parts below the root (%(default)s)",
    )
    parser.add_argument(
        "--keep", choices=("all",), help="GLB: the input with everything that it has, divided by part (no)"
    )
    parser.add_argument(
        "--output-unit", metavar="UNIT", help="OBJ, PLY and ZIP: convert the coordinates to this unit, such as mm"
    )
    parser.add_argument("--output-up", metavar="AXIS", help="OBJ, PLY and ZIP: turn the mesh so that y or z points up")
    closing = parser.add_mutually_exclusive_group()
    closing.add_argument(
        "--open",
        action="store_false",
        default=None,
        dest="capped",
        help="3MF and ZIP: write the parts as they are, open at their cuts",
    )
    closing.add_argument(
        "--capped",
        action="store_true",
        default=None,
        help="3MF and ZIP: close every part at its cuts (so by default, except OBJ)",
    )
    parser.add_argument(
        "--colors",
        choices=get_args(PlyColors),
        default="vertices",
        help="PLY: colours of segments on the vertices, divided between segments, or on the faces alone (%(default)s)",
    )
    parser.add_argument(
        "--parts", choices=get_args(PartFormat), default="stl", help="ZIP: format of its files (%(default)s)"
    )


@dataclass(frozen=True, slots=True)
class OutputOptions:
    """The options of the formats that were given on the command line."""

    values: dict[str, object]  # by their names in ``Writer.options``
    source: Path | None  # the file that the mesh was read from, if it is known
    keeps_all: bool
    standard_format: str | None = None  # of the standard output

    def with_values(self, **values: object) -> "OutputOptions":
        """Return the same with further values."""
        return replace(self, values=self.values | values)

    def writer_of(self, path: Path) -> Writer:
        """Return the writer for an output.

        Raises
        ------
        UnsupportedFormat
            If no format has the extension of the file.
        """
        return WRITERS[str(self.standard_format)] if path == STANDARD else writer_for(path.name)

    def of(self, writer: Writer) -> dict[str, object]:
        """Return those that a format has."""
        chosen: dict[str, object] = {name: value for name, value in self.values.items() if name in writer.options}
        if "keep" in writer.options and chosen.get("part_format", "glb") == "glb":
            wants = self.keeps_all or "part_format" in chosen
            chosen["keep"] = self._original() if wants else None
        return chosen

    def _original(self) -> "Original | None":
        from segcore.io import Original

        return Original(self.source, neighbours=True) if self.source else None


def output_options(choices: argparse.Namespace, source: Path | None) -> OutputOptions:
    """Return the options that were given.

    Parameters
    ----------
    source : the file that the mesh was read from; None if it is not known.

    Raises
    ------
    InvalidParameters
        If that file is to be kept and is not known, or the format of the standard output is not given.
    """
    if choices.keep and source is None:
        raise InvalidParameters("To keep everything of the input, name its file with --source.")
    values = {
        "all_levels": choices.all_levels,
        "features": choices.features,
        "layout": choices.layout,
        "capped": choices.capped,
        "unit": choices.output_unit,
        "up": choices.output_up,
        "part_format": choices.parts,
        "colors": choices.colors,
    }
    if STANDARD in choices.output and choices.to is None:
        raise InvalidParameters("The standard output has no extension: name its format, such as --to glb.")
    return OutputOptions(values, source, choices.keep == "all", choices.to)


def check_outputs(paths: Sequence[Path]) -> Callable[[str], None]:
    """Check the outputs before a long computation, and return the function that prints messages beside them.

    Raises
    ------
    InvalidParameters
        If two of them are the standard output.
    NotADirectoryError
        If a folder does not exist.
    """
    if paths.count(STANDARD) > 1:
        raise InvalidParameters("Two outputs are the standard output: write one of them to a file.")
    for path in paths:
        if not path.parent.is_dir():
            raise NotADirectoryError(20, "There is no such folder", str(path.parent))
    return say_beside if STANDARD in paths else say


def tell_written(tell: Callable[[str], None], paths: Sequence[Path]) -> None:
    """Say which files were written."""
    for path in paths:
        if path != STANDARD:
            tell(f"wrote {path}")


def write_model(
    path: Path, mesh: Mesh, hierarchy: Hierarchy, segments: int | None, options: OutputOptions
) -> tuple[str, ...]:
    """Write a segmented mesh in the format of the extension, with those of the options that the format has.

    The materials of an OBJ file are written beside it.

    Returns
    -------
    Notes on what could not be kept of the input.

    Raises
    ------
    UnsupportedFormat, InvalidParameters, OSError
    """
    writer = options.writer_of(path)
    chosen = options.of(writer)
    if writer.companion and path != STANDARD:
        beside = path.with_suffix(WRITERS[writer.companion].extension)
        write_model(beside, mesh, hierarchy, segments, options)
        chosen["library"] = beside.name
    notes: list[str] = []
    write_file(path, lambda target: notes.extend(writer.write(target, mesh, hierarchy, segments, **chosen) or ()))
    return tuple(notes)


def write_edited(path: Path, result: "Segmentation", options: OutputOptions) -> tuple[str, ...]:
    """Write the edited parts of a result, with their names and colours; a .cleave file keeps the hierarchy as well.

    Results and errors are those of :func:`write_model`.
    """
    edited = result.edited
    assert edited is not None, "the parts were edited"
    if options.writer_of(path) is WRITERS["cleave"]:
        return write_model(path, result.mesh, result.hierarchy, None, options.with_values(edited=edited))
    hierarchy, looks = edited_parts(result.mesh, edited)
    return write_model(path, result.mesh, hierarchy, None, options.with_values(**looks))


def edited_parts(mesh: Mesh, edited: "Edited") -> tuple[Hierarchy, dict[str, Any]]:
    """Return the edited parts as a hierarchy, and their names and colours as writers take them."""
    parts = edited.partition
    return parts.hierarchy(mesh), {"names": parts.names, "part_colors": parts.colors}


def write_file(path: Path, write: Callable[[BinaryIO], object]) -> None:
    """Write a file completely or not at all; anything but a regular file, such as a pipe, is written directly.

    If the standard output is a pipe that has been closed, the rest is not written.
    """
    if path == STANDARD:
        _write_standard(write)
    elif path.exists() and not path.is_file():
        with path.open("wb") as target:
            write(target)
    else:
        replace_file(path.resolve(), write)


def _write_standard(write: Callable[[BinaryIO], object]) -> None:
    content = io.BytesIO()
    write(content)
    try:
        sys.stdout.buffer.write(content.getbuffer())
        sys.stdout.buffer.flush()
    except BrokenPipeError:
        forget_output()


def _output(text: str) -> Path:
    if text == str(STANDARD):
        return STANDARD
    if Path(text).suffix.lower() not in _EXTENSIONS:
        raise argparse.ArgumentTypeError(f"{text!r} must end in one of {' '.join(_EXTENSIONS)}")
    return Path(text)
