"""The members of a ``.cleave`` file for parts that were edited; :mod:`segcore.io.result` documents them."""

import json
import zipfile
from dataclasses import asdict, dataclass, fields
from typing import Any

from segcore.errors import InvalidMesh, InvalidParameters
from segcore.io.archive import member, write_array
from segcore.io.edited.members import read_array, read_json
from segcore.io.edited.partition_file import part_document, part_of
from segcore.partition import Partition

_LABELS = "edited_labels"
_EDITS = "edits.json"


@dataclass(frozen=True, slots=True, kw_only=True)
class RevisionNote:
    """An entry of the list of revisions."""

    number: int  # 1, 2, ...
    parent: int  # 0 for the automatic result
    made_at: str  # RFC 3339
    made_by: str | None  # the name of the API key of the request
    what: str  # in words
    parts: int  # their number


@dataclass(frozen=True, slots=True, eq=False)
class Edited:
    """The parts of the newest revision, or of an earlier one, and the list of the revisions up to it."""

    partition: Partition
    revisions: tuple[RevisionNote, ...] = ()  # the oldest first

    @property
    def revision(self) -> int:
        """The number of the revision that has these parts; 0 if the list is empty."""
        return self.revisions[-1].number if self.revisions else 0


def write_edited(archive: zipfile.ZipFile, edited: Edited) -> None:
    """Add the members to an archive."""
    document = {
        "revision": edited.revision,
        "parts": [part_document(part) for part in edited.partition.parts],
        "revisions": [asdict(note) for note in edited.revisions],
    }
    archive.writestr(member(_EDITS), json.dumps(document))
    write_array(archive, _LABELS, edited.partition.labels, "<i4")


def read_edited(archive: zipfile.ZipFile, face_count: int) -> Edited | None:
    """Return what the members of an archive have; None if they are not there.

    Raises
    ------
    InvalidMesh
        If they are damaged, or there is not a label for each of ``face_count`` faces.
    """
    if _EDITS not in archive.namelist():
        return None
    labels, document = read_array(archive, _LABELS, "<i4"), read_json(archive, _EDITS)
    if not isinstance(document, dict) or labels.shape != (face_count,):
        raise _damaged()
    try:
        parts = tuple(part_of(entry) for entry in document["parts"])
        notes = tuple(_note(entry) for entry in document["revisions"])
        return Edited(Partition(labels, parts), notes)
    except (KeyError, TypeError, InvalidParameters) as error:
        raise _damaged() from error


def _note(entry: dict[str, Any]) -> RevisionNote:
    note = RevisionNote(**{one.name: entry[one.name] for one in fields(RevisionNote)})
    texts = (note.made_at, note.what, note.made_by or "")
    if not all(isinstance(text, str) for text in texts) or not all(
        type(number) is int for number in (note.number, note.parent, note.parts)
    ):
        raise _damaged()
    return note


def _damaged() -> InvalidMesh:
    return InvalidMesh("The edits in the .cleave file are damaged: make the file again.")
