"""An edit in a request: quick operations at once, others in a process that has the Guide of the job."""

from starlette.concurrency import run_in_threadpool

from segcore import Partition
from segcore.io import decode_partition, encode_partition
from service.context import Context
from service.edit.editor_process import EditorFailed
from service.edit.editors import GuideNotReady
from service.edit.messages import Message
from service.edit.queueing import queue_edit, waiting_edit
from service.edit.result_documents import EditedDocument, edited_document
from service.edit.revising import Edit, RequestKey, Revised, applied, begin_edit, store_edit
from service.guard.callers import Caller
from service.problems import STATUS, Problem
from worker.edits.operation_documents import EditDocument
from worker.jobs.job import Job
from worker.jobs.queued_edit import QueuedEdit

PREVIEW_PROBLEMS = ("guide_not_ready", "preview_too_slow")  # codes that preview_edit raises, besides others


async def preview_edit(context: Context, job: Job, document: EditDocument) -> EditedDocument:
    """Return the parts after an edit without storing them; errors as of :func:`make_edit`."""
    edit = await run_in_threadpool(begin_edit, context, job, document, None)
    assert isinstance(edit, Edit), "only a request with a key can have been made before"
    try:
        after = await parts_after(context, edit)
    except GuideNotReady:
        raise Problem("guide_not_ready") from None
    except EditorFailed:
        raise Problem("preview_too_slow") from None
    return await run_in_threadpool(edited_document, None, edit.before, after)


async def make_edit(
    context: Context, caller: Caller, job: Job, document: EditDocument, request: RequestKey | None
) -> Revised | QueuedEdit:
    """Make the next revision of a job, or enqueue an edit that takes longer than a request waits.

    Raises
    ------
    UnknownJob, Problem
        If the job has no result, or somebody else has made the next revision.
    UnknownRevision, RevisionDamaged
    InvalidParameters, PartLocked
        If an operation cannot be applied.
    """
    edit = await run_in_threadpool(begin_edit, context, job, document, request)
    if isinstance(edit, Revised):
        return edit
    queued = await run_in_threadpool(waiting_edit, context, edit)
    if queued is not None:
        return queued
    try:
        after = await parts_after(context, edit)
    except (GuideNotReady, EditorFailed):
        return await run_in_threadpool(queue_edit, context, caller, edit)
    return await run_in_threadpool(store_edit, context, caller, edit, after)


async def parts_after(context: Context, edit: Edit) -> Partition:
    """Return the parts after an edit, computed in this process if that needs no Guide.

    Raises
    ------
    GuideNotReady, EditorFailed
        If the parts are not computed within the time and the memory of the settings.
    Problem
        If an operation cannot be applied.
    """
    if not edit.needs_guide:
        return await run_in_threadpool(applied, context.results, edit)
    message = await run_in_threadpool(_message, edit)
    answer = await context.editors.ask(edit.job.id, message)
    return await run_in_threadpool(_parts_in, answer)


def _message(edit: Edit) -> Message:
    document = edit.document.model_dump(mode="json", by_alias=True)
    return Message({"job_id": edit.job.id, "edit": document}, encode_partition(edit.before))


def _parts_in(answer: Message) -> Partition:
    code = answer.document.get("code")
    if code is None:
        return decode_partition(answer.data)
    if code == "out_of_memory":
        raise EditorFailed
    raise Problem(code if code in STATUS else "invalid_parameters", answer.document["message"])
