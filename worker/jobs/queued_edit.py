"""An edit that waits in the queue, and how it ended."""

from dataclasses import dataclass
from datetime import datetime
from typing import Any, Literal

EditFailure = Literal["worker_lost", "out_of_memory", "timed_out"]

FAILURES: dict[EditFailure, str] = {
    "worker_lost": "The worker died while it computed this edit: ask the operator to check the log of the workers.",
    "out_of_memory": "The edit needs more memory than this installation gives it: edit a simpler mesh.",
    "timed_out": "The edit takes longer than this installation allows: send fewer operations.",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class QueuedEdit:
    """An edit of the newest revision of a job."""

    id: str  # like that of a job; derived from the Idempotency-Key if there is one
    job_id: str
    accepted_at: datetime  # UTC
    made_by: str | None
    request: str  # as in Revision; identifies the revision that this edit has made
    content: str | None
    edit: dict[str, Any]  # an EditDocument


@dataclass(frozen=True, slots=True, kw_only=True)
class EditOutcome:
    """How an edit has ended: with a revision, or with an error."""

    ended_at: datetime
    revision: int | None = None
    code: str | None = None  # stable, for programs
    message: str | None = None  # one sentence, for people
