"""Edits of the parts of a job, and the revisions that they make."""

import asyncio
import time
from typing import Annotated, Any

from fastapi import APIRouter, Header, Path, Query, Request
from starlette.concurrency import run_in_threadpool
from starlette.responses import Response

from cleave.settings import LONGEST_WAIT_S
from segcore.levels import Level
from service.answer.label_formats import LABELS
from service.answer.renditions import NOT_MODIFIED, answer_json
from service.answer.revision import REVISION_PATTERN, REVISION_PROBLEMS, revision_number
from service.context import ContextOf
from service.edit.body import read_body
from service.edit.editing import PREVIEW_PROBLEMS, make_edit, preview_edit
from service.edit.label_uploads import UploadedLabels, UploadedRuns
from service.edit.parts import parts_of
from service.edit.queueing import QueuedEditDocument, describe_edit, edit_has_ended
from service.edit.result_documents import (
    EditedDocument,
    RevisionPartsDocument,
    RevisionsDocument,
    edited_document,
    revision_document,
    revision_parts,
)
from service.edit.revising import EDIT_PROBLEMS, Revised, request_key
from service.edit.uploading import LabelUpload, store_labels
from service.guard.callers import CallerOf
from service.lookup import JOB_PROBLEMS, RESULT_PROBLEMS, JobId, check_succeeded, face_count, find_job
from service.mount import public_path
from service.openapi.document import ref
from service.problems import documented
from service.submit.body import media_type
from worker.edits.operation_documents import EditDocument, parsed_as
from worker.jobs.job import Job

router = APIRouter(prefix="/v1/jobs/{job_id}", tags=["edits"])

_JSON = "application/json"
IdempotencyKey = Annotated[
    str | None,
    Header(
        min_length=1,
        max_length=255,
        description="Any text that is unique per edit: the same request, sent again with it, makes no second revision.",
    ),
]
_PROBLEMS = (
    *RESULT_PROBLEMS,
    *EDIT_PROBLEMS,
    "foreign_site",
    "length_required",
    "too_large",
    "too_slow",
    "unsupported_media_type",
    "insufficient_storage",
)
_CREATED: dict[int | str, dict[str, Any]] = {
    201: {
        "model": EditedDocument,
        "description": "The revision is stored.",
        "headers": {"Location": {"schema": {"type": "string"}, "description": "The path of the revision."}},
    }
}
_QUEUED: dict[int | str, dict[str, Any]] = {
    202: {
        "model": QueuedEditDocument,
        "description": "The edit is stored and waits in the queue.",
        "headers": {
            "Location": {"schema": {"type": "string"}, "description": "The path of the edit."},
            "Retry-After": {"schema": {"type": "integer"}, "description": "Seconds."},
        },
    }
}
_POLL_S = 0.1  # between two looks for the end of an edit; set by hand
Wait = Annotated[
    float,
    Query(ge=0, le=LONGEST_WAIT_S, description="Seconds to wait for the end of the edit, up to a limit of the server."),
]
_EDIT_BODY = {"requestBody": {"required": True, "content": {_JSON: {"schema": ref(EditDocument)}}}}
_LABELS_BODY: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "description": "A label from 0 to 999999 for each face of the file, in its order. The parts are numbered in "
        "the order of their labels.",
        "content": {
            encoding.media_type.partition(";")[0]: {"schema": {"type": "string", "format": "binary"}}
            for encoding in LABELS.values()
        }
        | {
            _JSON: {"schema": {"anyOf": [ref(UploadedLabels), {"type": "array", "items": {"type": "integer"}}]}},
            "application/vnd.cleave.runs+json": {"schema": ref(UploadedRuns)},
            "text/plain": {"schema": {"type": "string"}, "example": "0\n0\n1\n2\n"},
        },
    }
}


@router.post(
    "/edits",
    status_code=201,
    response_class=Response,
    openapi_extra=_EDIT_BODY,
    responses=_CREATED | _QUEUED | documented(*_PROBLEMS),
)
async def create_edit(
    job_id: JobId,
    request: Request,
    context: ContextOf,
    caller: CallerOf,
    idempotency_key: IdempotencyKey = None,
) -> Response:
    """Edit the parts of the newest revision, which makes the next one.

    Parts have the numbers 0, 1, ... in the order of their labels. The numbers of untouched parts do not change; if a
    part vanishes, the part with the highest number takes its place and keeps its name, colour and class. An edit that
    takes longer than the server lets a request wait goes through the queue: then poll the Location of the response.
    """
    job = await run_in_threadpool(find_job, context, caller, job_id)
    body = await read_body(request, context.settings, await run_in_threadpool(face_count, context, job))
    document = await run_in_threadpool(parsed_as, EditDocument, body)
    key = await run_in_threadpool(request_key, context, caller, job, idempotency_key, body)
    made = await make_edit(context, caller, job, document, key)
    if isinstance(made, Revised):
        return await run_in_threadpool(_created, job, made)
    queued = await run_in_threadpool(describe_edit, context, job, made.id)
    headers = {"Location": queued.self, "Retry-After": "1"}
    return Response(queued.model_dump_json(), 202, headers, _JSON)


@router.post(
    "/edits/preview",
    response_model=EditedDocument,
    openapi_extra=_EDIT_BODY,
    responses=documented(*_PROBLEMS, *PREVIEW_PROBLEMS),
)
async def preview(job_id: JobId, request: Request, context: ContextOf, caller: CallerOf) -> Response:
    """The parts that an edit would make, without storing them."""
    job = await run_in_threadpool(find_job, context, caller, job_id)
    body = await read_body(request, context.settings, await run_in_threadpool(face_count, context, job))
    document = await run_in_threadpool(parsed_as, EditDocument, body)
    edited = await preview_edit(context, job, document)
    return Response(edited.model_dump_json(by_alias=True), media_type=_JSON)


@router.get(
    "/edits/{edit_id}",
    response_model=QueuedEditDocument,
    responses=documented(*JOB_PROBLEMS, *REVISION_PROBLEMS, "edit_not_found", "invalid_request")
    | {304: {"description": NOT_MODIFIED}},
)
async def get_edit(
    job_id: JobId,
    edit_id: Annotated[str, Path(description="As in the response to POST edits with the status 202.")],
    request: Request,
    context: ContextOf,
    caller: CallerOf,
    wait: Wait = 0,
) -> Response:
    """The state of an edit that went through the queue. With `wait` the response is sent when it has ended."""
    job = await run_in_threadpool(find_job, context, caller, job_id)
    document = await run_in_threadpool(describe_edit, context, job, edit_id)
    ends_at = time.monotonic() + min(wait, context.settings.max_wait_s)
    while document.ended_at is None and time.monotonic() < ends_at:
        await asyncio.sleep(max(_POLL_S, context.store.objects.poll_interval_s))
        if await run_in_threadpool(edit_has_ended, context, job, edit_id):
            document = await run_in_threadpool(describe_edit, context, job, edit_id)
    retry = {} if document.ended_at else {"Retry-After": "1"}
    return answer_json(request, document.model_dump_json().encode(), headers=retry)


@router.put(
    "/labels",
    status_code=201,
    response_class=Response,
    openapi_extra=_LABELS_BODY,
    responses=_CREATED | documented(*_PROBLEMS, "precondition_failed"),
)
async def put_labels(
    job_id: JobId,
    request: Request,
    context: ContextOf,
    caller: CallerOf,
    base: Annotated[
        int | None,
        Query(ge=0, lt=2**31, description="The newest revision; by default that of If-Match, or 0: there is none yet."),
    ] = None,
    if_match: Annotated[
        str | None, Header(max_length=1000, description="The ETag of GET labels?revision=latest, in place of base.")
    ] = None,
    idempotency_key: IdempotencyKey = None,
) -> Response:
    """Store labels that were made elsewhere as the next revision."""
    job = await run_in_threadpool(find_job, context, caller, job_id)
    body = await read_body(request, context.settings, await run_in_threadpool(face_count, context, job))
    key = await run_in_threadpool(request_key, context, caller, job, idempotency_key, body)
    upload = LabelUpload(body, media_type(request), base, if_match, key)
    return await run_in_threadpool(_created, job, await run_in_threadpool(store_labels, context, caller, job, upload))


@router.get(
    "/revisions",
    response_model=RevisionsDocument,
    responses=documented(*RESULT_PROBLEMS, *REVISION_PROBLEMS, "invalid_request")
    | {304: {"description": NOT_MODIFIED}},
)
def list_revisions(
    job_id: JobId,
    request: Request,
    context: ContextOf,
    caller: CallerOf,
    limit: Annotated[int, Query(ge=1, le=200, description="The maximum number of revisions on a page.")] = 50,
    before: Annotated[int | None, Query(ge=1, lt=2**31, description="Only older revisions than this.")] = None,
) -> Response:
    """The revisions, newest first."""
    job = find_job(context, caller, job_id)
    check_succeeded(context, job)
    page = context.store.revisions.page(job.id, before, limit)
    document = RevisionsDocument(
        newest=context.store.revisions.newest(job.id),
        revisions=[revision_document(revision) for revision in page.revisions],
        next=page.next,
    )
    return answer_json(request, document.model_dump_json().encode())


@router.get(
    "/revisions/{revision}",
    response_model=RevisionPartsDocument,
    responses=documented(*RESULT_PROBLEMS, *REVISION_PROBLEMS, "invalid_request")
    | {304: {"description": NOT_MODIFIED}},
)
def get_revision(
    job_id: JobId,
    request: Request,
    context: ContextOf,
    caller: CallerOf,
    revision: Annotated[str, Path(pattern=REVISION_PATTERN, description="The number of a revision, or latest.")],
) -> Response:
    """A revision with its parts."""
    job = find_job(context, caller, job_id)
    check_succeeded(context, job)
    number = revision_number(context, job, revision)
    document = revision_parts(
        context.store.revisions.revision(job.id, number), parts_of(context.results, job.id, number, Level())
    )
    return answer_json(request, document.model_dump_json(by_alias=True).encode())


def _created(job: Job, revised: Revised) -> Response:
    document = edited_document(revised.revision, revised.before, revised.after)
    path = public_path(f"/v1/jobs/{job.id}/revisions/{revised.revision.number}")
    return Response(document.model_dump_json(by_alias=True), 201, {"Location": path}, _JSON)
