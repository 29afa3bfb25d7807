"""`cleave convert`: write the segmentation of a .cleave file in other formats."""

import argparse
from dataclasses import replace
from pathlib import Path

from segcore.io import with_coordinates
from segcore.io.result import read_result
from segcore.levels import Fineness
from service.commands.arguments import add_coordinates, add_level
from service.commands.inputs import standard_input
from service.commands.outputs import (
    add_outputs,
    check_outputs,
    output_options,
    tell_written,
    write_edited,
    write_model,
)
from service.commands.summary import level_lines
from service.printing.command import add_print_options, print_options, write_prints
from service.robots.command import add_robot_options, robot_options, write_robots


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.description = "Write the segmentation of a .cleave file in other formats, with any number of segments."
    parser.add_argument(
        "result",
        type=Path,
        metavar="MESH.cleave",
        help="a file that cleave segment --result wrote; - for the standard input",
    )
    add_coordinates(parser)
    add_level(parser, "the edited parts, else the automatic one")
    add_outputs(parser, required=True)
    parser.add_argument("--source", type=Path, metavar="MESH", help="the file that was segmented, for --keep all")
    add_print_options(parser)
    add_robot_options(parser)


def run(choices: argparse.Namespace) -> None:
    """Write the files and print a summary. Edited parts are written unless a level is given.

    Raises
    ------
    CleaveError
        If the file is damaged, or there is no such level.
    OSError
        If a file cannot be read or written.
    """
    fineness, outputs = Fineness(choices.segments, choices.granularity), choices.output
    printing, robot, tell = print_options(choices), robot_options(choices), check_outputs(outputs)
    result = read_result(standard_input(choices.result))
    mesh = with_coordinates(result.mesh, choices.unit, choices.up)
    options = output_options(choices, choices.source)
    edited = result.edited if fineness.is_automatic else None
    segments = fineness.segments_of(result.hierarchy)
    if printing:
        notes = write_prints(choices, replace(result, mesh=mesh, edited=edited), segments, printing)
    elif robot:
        notes = write_robots(choices, replace(result, mesh=mesh, edited=edited), segments, robot)
    elif edited:
        shown = replace(result, mesh=mesh)
        notes = [note for path in outputs for note in write_edited(path, shown, options)]
    else:
        notes = [note for path in outputs for note in write_model(path, mesh, result.hierarchy, segments, options)]
    if edited:
        lines = [f"{len(edited.partition)} parts of revision {edited.revision}"]
    else:
        lines = level_lines(result.hierarchy, segments, fineness)
    for line in (*notes, *lines):
        tell(line)
    tell_written(tell, outputs)
