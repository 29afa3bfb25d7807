"""The list of parts of `cleave inspect --parts`."""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import segcore
from segcore.io import is_result_file, read_result
from segcore.levels import Fineness
from segcore.part_list.document import part_list_document
from service.commands.console import ProgressBar, say
from service.commands.inputs import STANDARD, input_name, standard_input
from service.commands.segment import read_and_compile

if TYPE_CHECKING:
    from segcore.part_list.listing import MeasuredPart
    from segcore.part_list.repeats import Repeat


@dataclass(frozen=True, slots=True, eq=False)
class _Chosen:
    mesh: segcore.Mesh
    partition: segcore.Partition


def print_parts(choices: argparse.Namespace) -> None:
    """Print the parts in a .cleave file, or those of a mesh, which is segmented first.

    Raises
    ------
    CleaveError
        If the file cannot be used, or there is no such level.
    OSError
        If the file cannot be read.
    """
    fineness = Fineness(choices.segments, choices.granularity)
    is_result = choices.mesh == STANDARD or is_result_file(choices.mesh)
    chosen = _stored(choices, fineness) if is_result else _segmented(choices, fineness)
    mesh, partition = chosen.mesh, chosen.partition
    listed = segcore.parts(mesh, partition.labels, partition.names)
    if choices.json:
        document = part_list_document(listed, mesh.coordinates.unit, partition.colors)
        say(json.dumps(document, indent=2, allow_nan=False))
        return
    unit = f", in units of {mesh.coordinates.unit}" if mesh.coordinates.unit else ""
    say(f"{input_name(choices.mesh)}: {len(partition)} part{'s' if len(partition) > 1 else ''}{unit}")
    for line in (*map(_part_line, listed.parts), *map(_repeat_line, listed.repeats.groups)):
        say(line)
    if not listed.repeats.is_complete:
        say("There are too many parts to compare all with each other: some copies may be missing.")


def _stored(choices: argparse.Namespace, fineness: Fineness) -> _Chosen:
    """Return the edited parts unless a level is given, else those of the level."""
    result = read_result(standard_input(choices.mesh))
    if result.edited is not None and fineness.is_automatic:
        return _Chosen(result.mesh, result.edited.partition)
    return _Chosen(result.mesh, segcore.Partition(result.hierarchy.labels(fineness.segments_of(result.hierarchy))))


def _segmented(choices: argparse.Namespace, fineness: Fineness) -> _Chosen:
    parameters = segcore.SegmentationParameters()
    if (choices.segments or 0) > parameters.segment_limit:
        parameters = replace(parameters, max_segments=choices.segments)
    with ProgressBar(sys.stderr) as bar:
        mesh = read_and_compile(choices, bar)
        hierarchy = segcore.segment(mesh, parameters, bar)
    return _Chosen(mesh, segcore.Partition(hierarchy.labels(fineness.segments_of(hierarchy))))


def _part_line(part: MeasuredPart) -> str:
    name = f" {part.name!r}" if part.name else ""
    volume = f"not closed ({part.why_no_volume})" if part.volume is None else f"volume {part.volume:.4g}"
    box = " x ".join(f"{extent:.4g}" for extent in part.box.extents)
    beside = ", ".join(str(neighbour.part) for neighbour in part.neighbours)
    faces = f"{part.faces} face{'s' if part.faces > 1 else ''}"
    line = f"  part {part.number}{name}: {faces}, area {part.area:.4g}, {volume}, box {box}"
    return f"{line}, beside {beside}" if beside else line


def _repeat_line(repeat: Repeat) -> str:
    mirrored = sum(copy.is_mirrored for copy in repeat.copies)
    worst = max(copy.relative_residual for copy in repeat.copies)
    parts = ", ".join(map(str, repeat.parts))
    note = f", {mirrored} of them mirrored" if mirrored else ""
    return f"equal: {len(repeat.copies)} parts, {parts}{note}; they deviate by up to {100 * worst:.2g} % of their size"
