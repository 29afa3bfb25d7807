"""Documents of revisions and of the results of edits."""

from typing import Any

import numpy as np
from pydantic import BaseModel, Field

from segcore import Partition
from segcore.arrays import IntArray
from segcore.io import segment_color_names
from service.problems import RevisionDocument
from worker.jobs.revision import Revision


class PartDocument(BaseModel):
    """A part of a revision; its number is its place in the list."""

    name: str = Field(description="Empty for none.", examples=["left arm"])
    color: str = Field(description="The colour that all files show.", examples=["#56b4e9"])
    class_name: str = Field(serialization_alias="class", description="Empty for none.", examples=["limb"])
    locked: bool
    faces: int


class ChangedFaces(BaseModel):
    """Faces with other labels than before, as runs: lengths[i] faces from starts[i] on have the label labels[i]."""

    starts: list[int]
    lengths: list[int]
    labels: list[int]


class EditedDocument(BaseModel):
    """The parts after an edit."""

    revision: RevisionDocument | None = Field(description="Null for a preview, which is not stored.")
    segments: int
    parts: list[PartDocument]
    changed: ChangedFaces


class RevisionPartsDocument(RevisionDocument):
    parts: list[PartDocument]


class RevisionsDocument(BaseModel):
    newest: int = Field(description="The base of the next edit; 0 if there is no revision yet.")
    revisions: list[RevisionDocument] = Field(description="Newest first; those that the store has lost are missing.")
    next: int | None = Field(description="Send it as before to get older ones; null if there are none.")


def revision_document(revision: Revision) -> RevisionDocument:
    return RevisionDocument(
        number=revision.number,
        parent=revision.parent,
        made_at=revision.made_at,
        made_by=revision.made_by,
        what=revision.what,
        segments=revision.parts,
    )


def revision_parts(revision: Revision, partition: Partition) -> RevisionPartsDocument:
    return RevisionPartsDocument(**revision_document(revision).model_dump(), parts=part_documents(partition))


def edited_document(revision: Revision | None, before: Partition, after: Partition) -> EditedDocument:
    return EditedDocument(
        revision=None if revision is None else revision_document(revision),
        segments=len(after),
        parts=part_documents(after),
        changed=ChangedFaces(**changed_runs(before.labels, after.labels)),
    )


def part_documents(partition: Partition) -> list[PartDocument]:
    fixed = segment_color_names(len(partition))
    return [
        PartDocument(
            name=part.name, color=part.color or color, class_name=part.class_name, locked=part.locked, faces=faces
        )
        for part, color, faces in zip(partition.parts, fixed, partition.face_counts.tolist(), strict=True)
    ]


def changed_runs(before: IntArray, after: IntArray) -> dict[str, Any]:
    """Return the faces whose labels (F,) differ as the longest runs of equal new labels."""
    differs = before != after
    shown = np.where(differs, after, -1)
    first = np.concatenate([[0], np.flatnonzero(np.diff(shown)) + 1])
    lengths = np.diff(first, append=len(shown))
    kept = shown[first] >= 0
    return {
        "starts": first[kept].tolist(),
        "lengths": lengths[kept].tolist(),
        "labels": shown[first][kept].tolist(),
    }
