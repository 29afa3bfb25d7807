"""`cleave segment`: segment one mesh file without a server."""

import argparse
import json
import sys
import threading
from collections.abc import Callable
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import BinaryIO

import segcore
from segcore.io.labels import hierarchy_document, write_seg
from segcore.io.result import write_result
from segcore.kernels import FIRST, READ, compile_kernels, must_compile
from segcore.levels import Fineness
from segcore.report import StructureCounts, structure_counts, structure_note
from service.commands.arguments import add_level, add_parameters, add_structure
from service.commands.console import ProgressBar, say_beside
from service.commands.inputs import STANDARD, add_mesh, input_name, read_input
from service.commands.outputs import (
    OutputOptions,
    add_outputs,
    check_outputs,
    output_options,
    tell_written,
    write_file,
    write_model,
)
from service.commands.summary import level_lines, part_lines

_POLL_S = 0.05  # of the kernels of the readers


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.description = "Segment one mesh and write the outputs; without outputs, only a summary is printed."
    add_mesh(parser)
    add_level(parser, "chosen by the mesh")
    parser.add_argument("--max-segments", type=int, metavar="N", help="end of the hierarchy (64, or K, or bodies)")
    parser.add_argument("--preset", metavar="NAME", help="a published method, such as chahhou2014")
    add_structure(parser)
    add_parameters(parser, "solver=inverse_power")
    parser.add_argument(
        "--threads",
        type=int,
        metavar="N",
        help="threads; the result is the same (idle cores from 200,000 faces on, or 1)",
    )
    add_outputs(parser)
    parser.add_argument("--labels", type=Path, metavar="LABELS.seg", help="the segment of every face, one per line")
    parser.add_argument("--hierarchy", type=Path, metavar="TREE.json", help="the tree of cuts")
    parser.add_argument("--result", type=Path, metavar="MESH.cleave", help="mesh and tree, for cleave convert")


def run(choices: argparse.Namespace) -> None:
    """Segment the file, write the outputs and print a summary.

    Raises
    ------
    CleaveError
        If the mesh or a parameter cannot be used.
    OSError
        If a file cannot be read or written.
    """
    fineness = Fineness(choices.segments, choices.granularity)
    parameters = _parameters(choices)
    outputs = [*choices.output, *filter(None, (choices.labels, choices.hierarchy, choices.result))]
    tell = check_outputs(outputs)
    options = output_options(choices, None if choices.mesh == STANDARD else choices.mesh)
    with ProgressBar(sys.stderr) as bar:
        bar("read", 0.0)
        mesh = read_and_compile(choices, bar)
        surface = segcore.build_surface(mesh)
        hierarchy = segcore.segment(mesh, parameters, bar, surface, choices.threads)
        segments = fineness.segments_of(hierarchy)
        notes = _write(choices, options, mesh, hierarchy, segments)
    tell(f"{input_name(choices.mesh)}: {len(mesh.faces)} faces, {len(mesh.vertices)} vertices")
    for note in (*mesh.notes, *notes):
        tell(note)
    for line in (*level_lines(hierarchy, segments, fineness), *part_lines(hierarchy, segments)):
        tell(line)
    for line in _structure_lines(structure_counts(mesh, surface), parameters):
        tell(line)
    tell_written(tell, outputs)


def read_and_compile(choices: argparse.Namespace, bar: ProgressBar) -> segcore.Mesh:
    """Read the mesh file of a command; at the first use, compile meanwhile what every segmentation needs.

    The kernels of the readers are compiled first, and awaited. Without a terminal one line says so. If the file cannot
    be read, the compilation ends with the process.
    """
    if not must_compile(FIRST):
        return read_input(choices)
    if not sys.stderr.isatty():
        say_beside("Compiling the kernels, which takes up to half a minute and is done once.")
    errors: list[OSError] = []

    def compile_first() -> None:
        try:
            compile_kernels(FIRST, lambda progress: bar(str(progress), progress.done / progress.count))
        except OSError as error:
            errors.append(error)

    compilation = threading.Thread(target=compile_first, daemon=True)
    compilation.start()
    while compilation.is_alive() and must_compile([READ]):
        compilation.join(_POLL_S)
    mesh = read_input(choices)
    import_module("segcore.method")  # needed next
    compilation.join()
    if errors:
        raise errors[0]
    return mesh


def _parameters(choices: argparse.Namespace) -> segcore.SegmentationParameters:
    """Return the parameters, with a hierarchy that is large enough for ``--segments``."""
    named = {"preset": choices.preset, "max_segments": choices.max_segments, "structure": choices.structure}
    given = dict(choices.parameters) | {name: value for name, value in named.items() if value is not None}
    parameters = segcore.SegmentationParameters.from_mapping(given)
    segments = choices.segments
    if segments is None:
        return parameters
    if segments < 1:
        raise segcore.InvalidParameters(f"The number of segments must be at least 1, not {segments}.")
    if segments <= parameters.segment_limit:
        return parameters
    return replace(parameters, max_segments=segments)


def _structure_lines(counts: StructureCounts, parameters: segcore.SegmentationParameters) -> list[str]:
    """Return what structure the file has if it is of several parts, and how it limits the hierarchy."""
    note = structure_note(counts, parameters.structure, parameters.segment_limit)
    return ([f"structure of the file: {counts.in_words()}"] if counts.has_parts else []) + ([note] if note else [])


def _write(
    choices: argparse.Namespace, options: OutputOptions, mesh: segcore.Mesh, hierarchy: segcore.Hierarchy, segments: int
) -> list[str]:
    """Write all outputs; return notes on what could not be kept of the input."""
    notes = [note for path in choices.output for note in write_model(path, mesh, hierarchy, segments, options)]
    document = hierarchy_document(hierarchy)
    writers: list[tuple[Path | None, Callable[[BinaryIO], object]]] = [
        (choices.labels, lambda target: write_seg(target, hierarchy.labels(segments))),
        (choices.hierarchy, lambda target: target.write(json.dumps(document, allow_nan=False).encode())),
        (choices.result, lambda target: write_result(target, mesh, hierarchy)),
    ]
    for named, write in writers:
        if named is not None:
            write_file(named, write)
    return notes
