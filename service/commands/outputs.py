"""Files that the command line writes: by their extension, whole or not at all."""

import argparse
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from segcore.hierarchy import Hierarchy
from segcore.io.gltf.writer import write_glb
from segcore.io.parts.writer import PartFormat, write_parts
from segcore.io.threemf.writer import write_3mf
from segcore.io.writing import writer_for
from segcore.mesh import Mesh
from worker.jobs.objects.durable import replace_file


@dataclass(frozen=True, slots=True, kw_only=True)
class OutputOptions:
    """What some of the formats can do beside the usual."""

    all_levels: bool = False  # GLB: every level as a variant of the materials
    features: bool = False  # GLB: the hierarchy as a property table, and feature ids that lead to it
    capped: bool = False  # 3MF and ZIP: every part closed
    part_format: PartFormat = "stl"  # of the files in a ZIP archive


def output_options(choices: argparse.Namespace) -> OutputOptions:
    return OutputOptions(
        all_levels=choices.all_levels, features=choices.features, capped=choices.capped, part_format=choices.parts
    )


def check_outputs(paths: Sequence[Path]) -> None:
    """Say before the work, not after it, that a file could not be written.

    Raises
    ------
    NotADirectoryError
        Where a folder is missing.
    """
    for path in paths:
        if not path.parent.is_dir():
            raise NotADirectoryError(20, "There is no such folder", str(path.parent))


def write_model(path: Path, mesh: Mesh, hierarchy: Hierarchy, segments: int | None, options: OutputOptions) -> None:
    """Write a segmented mesh in the format that the extension names.

    Raises
    ------
    UnsupportedFormat, InvalidParameters, OSError
    """
    write_file(path, lambda target: _write(target, path, mesh, hierarchy, segments, options))


def write_file(path: Path, write: Callable[[BinaryIO], object]) -> None:
    """Write a file whole or not at all; what is not a file, a pipe for instance, is written as it is."""
    if path.exists() and not path.is_file():
        with path.open("wb") as target:
            write(target)
    else:
        replace_file(path.resolve(), write)


def _write(
    target: BinaryIO, path: Path, mesh: Mesh, hierarchy: Hierarchy, segments: int | None, options: OutputOptions
) -> None:
    match path.suffix.lower():
        case ".glb":
            write_glb(target, mesh, hierarchy, segments, all_levels=options.all_levels, features=options.features)
        case ".3mf":
            write_3mf(target, mesh, hierarchy, segments, capped=options.capped)
        case ".zip":
            write_parts(target, mesh, hierarchy, segments, part_format=options.part_format, capped=options.capped)
        case _:
            writer_for(path.name).write(target, mesh, hierarchy, segments)
