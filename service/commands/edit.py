"""`cleave edit`: edit the parts in a .cleave file without a server."""

import argparse
import sys
from dataclasses import replace
from datetime import UTC, datetime
from functools import cache
from pathlib import Path

import segcore
from segcore import InvalidParameters, Partition
from segcore.edit.operations import apply_all, in_words
from segcore.edit.tools import Tools
from segcore.io import Edited, RevisionNote, Segmentation, read_result
from segcore.levels import Level
from service.commands.inputs import STANDARD, standard_input
from service.commands.outputs import add_outputs, check_outputs, output_options, tell_written, write_edited
from worker.edits.operation_documents import LocalEditDocument, parsed_as


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.description = (
        "Edit the parts in a .cleave file: merge, cut, move faces, name, colour, lock. Without outputs the file itself "
        "gets the new parts; the automatic result stays in it."
    )
    parser.add_argument(
        "result", type=Path, metavar="MESH.cleave", help="a file of cleave segment --result or of a server"
    )
    parser.add_argument(
        "--operations",
        type=Path,
        required=True,
        metavar="EDITS.json",
        help="the operations, as in the body of POST /v1/jobs/{job_id}/edits; - for the standard input",
    )
    add_outputs(parser)
    parser.add_argument("--source", type=Path, metavar="MESH", help="the file that was segmented, for --keep all")


def run(choices: argparse.Namespace) -> None:
    """Apply the operations, write the files and print a summary.

    Raises
    ------
    CleaveError
        If a file is damaged, or an operation cannot be applied.
    OSError
        If a file cannot be read or written.
    """
    outputs = choices.output or [choices.result]
    tell = check_outputs(outputs)
    options = output_options(choices, choices.source)
    text = sys.stdin.buffer.read() if choices.operations == STANDARD else choices.operations.read_bytes()
    document = parsed_as(LocalEditDocument, text)
    result = read_result(standard_input(choices.result))
    edited = edited_result(result, document)
    for path in outputs:
        for note in write_edited(path, edited, options):
            tell(note)
    assert edited.edited is not None, "it was edited"
    made = edited.edited.revisions[-1]
    tell(f"revision {made.number}: {made.what}; {made.parts} part{'s' if made.parts != 1 else ''}")
    tell_written(tell, outputs)


def edited_result(result: Segmentation, document: LocalEditDocument) -> Segmentation:
    """Return a result with the parts after an edit, and with one more revision.

    Raises
    ------
    InvalidParameters, PartLocked
        If the edit is one of another revision, or an operation cannot be applied.
    """
    known = result.edited.revisions if result.edited else ()
    newest = known[-1].number if known else 0
    if document.base not in (None, newest):
        raise InvalidParameters(
            f"The file has revision {newest} and the edit is one of {document.base}: adapt its base."
        )
    operations, level = document.all(), document.level_of_base(newest)
    tools = Tools(
        guide=cache(lambda: segcore.Guide(result.mesh, result.hierarchy)),
        earlier=lambda number, of: _parts_of(result, number, of),
    )
    after = apply_all(_parts_of(result, newest, level), operations, tools)
    note = RevisionNote(
        number=newest + 1,
        parent=newest,
        made_at=datetime.now(UTC).isoformat(),
        made_by=None,
        what=in_words(operations),
        parts=len(after),
    )
    return replace(result, edited=Edited(after, (*known, note)))


def _parts_of(result: Segmentation, revision: int, level: Level) -> Partition:
    if revision == 0:
        return Partition(level.labels(result.hierarchy))
    if result.edited is None or result.edited.revision != revision:
        raise InvalidParameters(f"The file has the parts of its newest revision and of 0, not those of {revision}.")
    return result.edited.partition
