"""The documents of the API as values."""

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

Status: TypeAlias = Literal["queued", "running", "succeeded", "failed", "canceled"]
Labels: TypeAlias = NDArray[np.int32]  # (F,) the segment of every face, in the order of the file


@dataclass(frozen=True, slots=True)
class JobError:
    """Why a job failed."""

    code: str
    message: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Job:
    """The state of a job at the time of the response."""

    id: str
    status: Status
    stage: str | None
    progress: float  # 0..1
    seconds_left: int | None  # an estimate; None if there is none
    queue_position: int | None
    waits_for: str | None  # what a waiting job waits for, apart from the jobs before it
    created_at: datetime
    finished_at: datetime | None
    file_name: str | None
    faces: int | None
    max_segments: int | None
    automatic_segments: int | None
    limit_reached: bool | None  # whether a limit of max_segments ended the hierarchy; None if that is not known
    error: JobError | None
    document: Mapping[str, Any]  # the complete JSON document

    @property
    def has_ended(self) -> bool:
        return self.finished_at is not None


@dataclass(frozen=True, slots=True)
class Segmentation:
    """The labels of a job at a number of segments."""

    job: Job
    segments: int
    labels: Labels


@dataclass(frozen=True, slots=True)
class Revision:
    """The parts of a job after an edit."""

    number: int  # 1, 2, ...
    parent: int  # the revision that was edited; 0 is the automatic result
    made_at: datetime
    made_by: str | None  # the name of the API key
    what: str  # the operations, in words
    segments: int  # the number of parts


@dataclass(frozen=True, slots=True)
class Part:
    """A part of a revision."""

    name: str
    color: str  # #rrggbb
    class_name: str
    locked: bool
    faces: int


@dataclass(frozen=True, slots=True)
class Edited:
    """The parts after an edit; part k has the label k."""

    revision: Revision | None  # None for a preview
    parts: list[Part]
    document: Mapping[str, Any]  # the JSON document, with the faces that have changed if the edit did not wait


def job_from(document: Mapping[str, Any]) -> Job:
    error, mesh = document["error"], document["mesh"]
    finished = document["finished_at"]
    return Job(
        id=document["id"],
        status=document["status"],
        stage=document["stage"],
        progress=document["progress"],
        seconds_left=document.get("seconds_left"),  # servers of earlier versions do not send it
        queue_position=document["queue_position"],
        waits_for=document.get("waits_for"),  # servers of earlier versions do not send it
        created_at=datetime.fromisoformat(document["created_at"]),
        finished_at=None if finished is None else datetime.fromisoformat(finished),
        file_name=document["input"]["file_name"],
        faces=None if mesh is None else mesh["faces"],
        max_segments=document["max_segments"],
        automatic_segments=document["automatic_segments"],
        limit_reached=document.get("limit_reached"),  # servers of earlier versions do not send it
        error=None if error is None else JobError(error["code"], error["message"]),
        document=document,
    )


def revision_from(document: Mapping[str, Any]) -> Revision:
    return Revision(
        number=document["number"],
        parent=document["parent"],
        made_at=datetime.fromisoformat(document["made_at"]),
        made_by=document["made_by"],
        what=document["what"],
        segments=document["segments"],
    )


def edited_from(document: Mapping[str, Any]) -> Edited:
    revision = document["revision"]
    parts = [
        Part(part["name"], part["color"], part["class"], part["locked"], part["faces"]) for part in document["parts"]
    ]
    return Edited(None if revision is None else revision_from(revision), parts, document)
