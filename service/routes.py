"""The job API: submit a mesh, poll the job, cancel it, delete it."""

from dataclasses import asdict
from typing import Annotated, Any

from fastapi import APIRouter, Header, Path, Query, Request
from starlette.concurrency import run_in_threadpool
from starlette.responses import Response, StreamingResponse

from service.answers import answer_json
from service.context import Context, ContextOf
from service.documents import JobDocument, JobPageDocument, Status
from service.events import has_seen_the_end, job_events
from service.lookup import describe, describe_all, known_job
from service.problems import Problem, documented
from service.upload import file_label, mesh_format, parse_parameters, receive_form
from service.waiting import wait_for_end
from worker.index import CURSOR
from worker.jobs import Canceled, Job, new_job_id, now
from worker.queue import QueueError

router = APIRouter(prefix="/v1/jobs", tags=["jobs"])

JobId = Annotated[str, Path(description="As in the answer to POST /v1/jobs.")]

NOT_MODIFIED = "The client has it already: If-None-Match names its ETag."

_FORM: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {
            "multipart/form-data": {
                "schema": {
                    "type": "object",
                    "required": ["mesh"],
                    "properties": {
                        "mesh": {"type": "string", "format": "binary", "description": "A mesh file."},
                        "parameters": {
                            "type": "string",
                            "contentMediaType": "application/json",
                            "description": 'A JSON object such as {"max_segments": 32}.',
                        },
                    },
                }
            }
        },
    }
}


@router.post(
    "",
    status_code=202,
    response_model=JobDocument,
    openapi_extra=_FORM,
    responses=documented(
        "malformed_request",
        "too_large",
        "unsupported_media_type",
        "invalid_mesh",
        "invalid_parameters",
        "queue_unavailable",
        "storage_full",
    ),
)
async def create_job(request: Request, response: Response, context: ContextOf) -> JobDocument:
    """Submit a mesh. The job is durable when this answers; poll the Location until it has finished."""
    # A queue that is down is said before the upload: nobody could run the job, and jobs that nobody runs would fill the
    # disk without a bound. Once the job is in the store it is accepted, and the janitor sees to the queue if need be.
    await run_in_threadpool(context.queue.connection.ping)
    job = await _accept(request, context)
    await run_in_threadpool(_enqueue, context, job.id)
    response.headers.update({"Location": f"/v1/jobs/{job.id}", "Retry-After": "1"})
    return await run_in_threadpool(describe, context, job)


@router.get(
    "", response_model=JobPageDocument, responses=documented("invalid_request") | {304: {"description": NOT_MODIFIED}}
)
def list_jobs(
    request: Request,
    context: ContextOf,
    limit: Annotated[int, Query(ge=1, le=200, description="The most jobs on a page.")] = 50,
    cursor: Annotated[
        str | None, Query(pattern=CURSOR, description="The next_cursor of the page before; none for the first page.")
    ] = None,
    status: Annotated[Status | None, Query(description="Jobs of this status only.")] = None,
) -> Response:
    """The jobs, newest first."""
    page = context.store.page(None, cursor, limit)
    jobs = [job for job in describe_all(context, page.jobs) if status in (None, job.status)]
    document = JobPageDocument(jobs=jobs, next_cursor=page.next_cursor)
    return answer_json(request, document.model_dump_json().encode())


@router.get(
    "/{job_id}",
    response_model=JobDocument,
    responses=documented("job_not_found", "job_deleted", "invalid_request") | {304: {"description": NOT_MODIFIED}},
)
async def get_job(
    job_id: JobId,
    request: Request,
    context: ContextOf,
    wait: Annotated[float, Query(ge=0, le=60, description="Seconds to wait for the end of the job.")] = 0,
) -> Response:
    """How a job is. With ``wait`` the answer comes when the job has ended, or after so many seconds."""
    job = await run_in_threadpool(known_job, context, job_id)
    if wait:
        await wait_for_end(context.store, job.id, wait)
    document = await run_in_threadpool(describe, context, job)
    retry = {} if document.finished_at else {"Retry-After": "1"}
    return answer_json(request, document.model_dump_json().encode(), headers=retry)


@router.get(
    "/{job_id}/events",
    response_class=StreamingResponse,
    responses={
        200: {
            "description": "A stream of events `status`, each with a job document as its data. The last one is that "
            "of the end of the job.",
            "content": {"text/event-stream": {"schema": {"type": "string"}}},
        },
        204: {"description": "The job has ended and Last-Event-ID is that of the last event: do not come back."},
        **documented("job_not_found", "job_deleted", "invalid_request"),
    },
)
async def get_events(
    job_id: JobId,
    context: ContextOf,
    last_event_id: Annotated[
        int, Header(ge=0, le=2**53, description="The id of the last event that the client has seen.")
    ] = 0,
) -> Response:
    """The job as it goes, as server-sent events."""
    job = await run_in_threadpool(known_job, context, job_id)
    if has_seen_the_end(await run_in_threadpool(describe, context, job), last_event_id):
        return Response(status_code=204)
    stream = job_events(context, job, last_event_id)
    return StreamingResponse(stream, media_type="text/event-stream", headers={"Cache-Control": "no-store"})


@router.post(
    "/{job_id}/cancel",
    response_model=JobDocument,
    responses=documented("job_not_found", "job_deleted", "already_finished", "storage_full"),
)
def cancel_job(job_id: JobId, context: ContextOf) -> JobDocument:
    """Cancel a job: one that waits at once, one that runs within seconds. A second time changes nothing."""
    job = known_job(context, job_id)
    outcome = context.store.finish(job.id, Canceled(finished_at=now()))
    if not isinstance(outcome, Canceled):
        raise Problem("already_finished", f"The job has {outcome.status} already: delete it to remove its files.")
    _forget(context, job.id)
    return describe(context, job)


@router.delete(
    "/{job_id}",
    status_code=204,
    response_class=Response,
    responses=documented("job_not_found", "job_deleted", "storage_full"),
)
def delete_job(job_id: JobId, context: ContextOf) -> None:
    """Remove a job with its files; one that has not finished is canceled first."""
    job = known_job(context, job_id)
    context.store.finish(job.id, Canceled(finished_at=now()))
    context.store.delete(job.id)
    context.results.drop(job.id)
    _forget(context, job.id)


async def _accept(request: Request, context: Context) -> Job:
    with context.store.begin_upload() as upload:
        form = await receive_form(request, upload, context.settings.max_upload_bytes)
        job = Job(
            id=new_job_id(),
            sha256=upload.sha256,
            size_bytes=upload.size_bytes,
            mesh_format=mesh_format(form.file_name),
            parameters=asdict(parse_parameters(form.parameters)),
            created_at=now(),
            file_name=file_label(form.file_name),
        )
        await run_in_threadpool(context.store.accept, job, upload)
    return job


def _enqueue(context: Context, job_id: str) -> None:
    try:
        context.queue.enqueue(job_id)
    except QueueError:
        return  # the janitor will


def _forget(context: Context, job_id: str) -> None:
    try:
        context.queue.forget(job_id)
    except QueueError:
        return  # the worker that takes the entry drops it
