"""Edits that take longer than a request waits: they go through the queue, as jobs do."""

import logging
from datetime import datetime
from typing import Annotated, Any, Literal

from pydantic import BaseModel, Field
from typing_extensions import TypeAliasType

from service.context import Context
from service.edit.result_documents import revision_document
from service.edit.revising import Edit
from service.guard.callers import Caller
from service.mount import public_path
from service.problems import STATUS, Problem, RevisionDocument
from worker.jobs.attempts import FAILURE_CODES
from worker.jobs.job import Job, new_job_id, now
from worker.jobs.queue.connection import QueueError
from worker.jobs.queued_edit import QueuedEdit
from worker.jobs.size_class import size_class
from worker.jobs.store.store import UnknownJob

log = logging.getLogger("cleave.service")


class EditError(BaseModel):
    """Why an edit failed."""

    code: str = Field(
        description="That of a problem, or the cause of a lost run; stable, for programs.",
        json_schema_extra={"enum": list(dict.fromkeys((*STATUS, *FAILURE_CODES)))},
    )
    message: str = Field(description="One sentence for people.")


class _Edit(BaseModel):
    id: str
    status: Literal["queued", "succeeded", "failed"]
    accepted_at: datetime
    ended_at: datetime | None
    revision: RevisionDocument | None = Field(description="The revision that it has made.")
    error: EditError | None = Field(description="Why it has failed; null if it has not.")
    self: str = Field(description="The path of the edit.")


class WaitingEdit(_Edit):
    """An edit that waits in the queue."""

    status: Literal["queued"]


class SucceededEdit(_Edit):
    """An edit that has made a revision."""

    status: Literal["succeeded"]
    ended_at: datetime
    revision: RevisionDocument = Field(description="The revision that it has made.")


class FailedEdit(_Edit):
    """An edit that has made no revision."""

    status: Literal["failed"]
    ended_at: datetime
    error: EditError = Field(description="Why it has failed.")


QueuedEditDocument = TypeAliasType(
    "QueuedEditDocument", Annotated[WaitingEdit | SucceededEdit | FailedEdit, Field(discriminator="status")]
)


def edit_id_of(edit: Edit) -> str:
    """Return the id of an edit, which is the same for a request that is sent again."""
    return new_job_id() if edit.request is None else edit.request.key[:32]


def waiting_edit(context: Context, edit: Edit) -> QueuedEdit | None:
    """Return the same edit if it was sent before and waits in the queue.

    Raises
    ------
    Problem
        If its Idempotency-Key was sent with another edit.
    """
    if edit.request is None:
        return None
    queued = context.store.queued_edits.find(edit.job.id, edit_id_of(edit))
    if queued is not None and queued.content != edit.request.content:
        raise Problem("idempotency_key_reused")
    return queued


def queue_edit(context: Context, caller: Caller, edit: Edit) -> QueuedEdit:
    """Store an edit and enqueue it.

    Raises
    ------
    UnknownJob
        If the job was deleted.
    """
    edit_id = edit_id_of(edit)
    queued = QueuedEdit(
        id=edit_id,
        job_id=edit.job.id,
        accepted_at=now(),
        made_by=caller.owner,
        request=edit_id if edit.request is None else edit.request.key,
        content=None if edit.request is None else edit.request.content,
        edit=edit.document.model_dump(mode="json", by_alias=True),
    )
    context.store.queued_edits.accept(queued)
    try:
        context.queue.enqueue(edit_id, size_class(edit.job, context.settings.large_job_bytes))
    except QueueError:
        log.warning("the edit could not be enqueued; the janitor will enqueue it")
    return queued


def describe_edit(context: Context, job: Job, edit_id: str) -> QueuedEditDocument:
    """Return the document of an edit that went through the queue.

    Raises
    ------
    Problem
        If there is none of this id.
    """
    edit = context.store.queued_edits.find(job.id, edit_id)
    if edit is None:
        raise Problem("edit_not_found")
    outcome = context.store.queued_edits.outcome(job.id, edit_id)
    fields: dict[str, Any] = {
        "id": edit.id,
        "accepted_at": edit.accepted_at,
        "ended_at": None if outcome is None else outcome.ended_at,
        "revision": None,
        "error": None,
        "self": public_path(f"/v1/jobs/{job.id}/edits/{edit.id}"),
    }
    if outcome is None:
        return WaitingEdit(status="queued", **fields)
    if outcome.revision is None:
        error = EditError(code=outcome.code or "internal_error", message=outcome.message or "")
        return FailedEdit(status="failed", **fields | {"error": error})
    revision = revision_document(context.store.revisions.revision(job.id, outcome.revision))
    return SucceededEdit(status="succeeded", **fields | {"revision": revision})


def edit_has_ended(context: Context, job: Job, edit_id: str) -> bool:
    """Return whether an edit has an outcome.

    Raises
    ------
    UnknownJob
        If the job was deleted.
    """
    if not context.store.records.has_job(job.id):
        raise UnknownJob(job.id)
    return context.store.queued_edits.outcome(job.id, edit_id) is not None
