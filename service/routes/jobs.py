"""Jobs: list them, poll one or listen to it, cancel it, delete it."""

from typing import Annotated

from fastapi import APIRouter, Header, Path, Query, Request
from starlette.concurrency import run_in_threadpool
from starlette.responses import Response, StreamingResponse

from cleave.settings import LONGEST_WAIT_S
from service.answer.events import EVENT_SCHEMA, has_seen_the_end, job_events
from service.answer.renditions import NOT_MODIFIED, answer_json
from service.answer.waiting import wait_for_end
from service.context import ContextOf
from service.documents import JobDocument, JobPageDocument, Status
from service.guard.callers import CallerOf
from service.lookup import describe, describe_all, known_job
from service.problems import Problem, documented
from worker.jobs.job import Canceled
from worker.jobs.store.index import CURSOR

router = APIRouter(prefix="/v1/jobs", tags=["jobs"])

_CHANGE_PROBLEMS = documented("unauthorized", "foreign_site", "job_not_found", "job_deleted", "insufficient_storage")

JobId = Annotated[str, Path(description="As in the answer to POST /v1/jobs.")]


@router.get(
    "",
    response_model=JobPageDocument,
    responses=documented("unauthorized", "invalid_request") | {304: {"description": NOT_MODIFIED}},
)
def list_jobs(
    request: Request,
    context: ContextOf,
    caller: CallerOf,
    limit: Annotated[int, Query(ge=1, le=200, description="The most jobs on a page.")] = 50,
    cursor: Annotated[
        str | None, Query(pattern=CURSOR, description="The next_cursor of the page before; none for the first page.")
    ] = None,
    status: Annotated[Status | None, Query(description="Jobs of this status only.")] = None,
) -> Response:
    """The jobs, newest first."""
    page = context.store.page(caller.owner, cursor, limit)
    jobs = [job for job in describe_all(context, page.jobs) if status in (None, job.status)]
    document = JobPageDocument(jobs=jobs, next_cursor=page.next_cursor)
    return answer_json(request, document.model_dump_json().encode())


@router.get(
    "/{job_id}",
    response_model=JobDocument,
    responses=documented("unauthorized", "job_not_found", "job_deleted", "invalid_request")
    | {304: {"description": NOT_MODIFIED}},
)
async def get_job(
    job_id: JobId,
    request: Request,
    context: ContextOf,
    caller: CallerOf,
    wait: Annotated[
        float,
        Query(
            ge=0, le=LONGEST_WAIT_S, description="Seconds to wait, if the server waits so long, for the end of the job."
        ),
    ] = 0,
) -> Response:
    """How a job is. With ``wait`` the answer comes when the job has ended, or after so many seconds."""
    job = await run_in_threadpool(known_job, context, caller, job_id)
    if wait:
        await wait_for_end(context.store, job.id, min(wait, context.settings.max_wait_s))
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
            "content": {"text/event-stream": {"schema": EVENT_SCHEMA}},
        },
        204: {"description": "The job has ended and Last-Event-ID is that of the last event: do not come back."},
        **documented("unauthorized", "job_not_found", "job_deleted", "invalid_request"),
    },
)
async def get_events(
    job_id: JobId,
    context: ContextOf,
    caller: CallerOf,
    last_event_id: Annotated[
        int, Header(ge=0, le=2**53, description="The id of the last event that the client has seen.")
    ] = 0,
) -> Response:
    """The job as it goes, as server-sent events."""
    job = await run_in_threadpool(known_job, context, caller, job_id)
    if has_seen_the_end(await run_in_threadpool(describe, context, job), last_event_id):
        return Response(status_code=204)
    stream = job_events(context, job, last_event_id)
    return StreamingResponse(stream, media_type="text/event-stream", headers={"Cache-Control": "no-store"})


@router.post(
    "/{job_id}/cancel",
    response_model=JobDocument,
    responses=documented(
        "unauthorized", "foreign_site", "job_not_found", "job_deleted", "already_finished", "insufficient_storage"
    ),
)
def cancel_job(job_id: JobId, context: ContextOf, caller: CallerOf) -> JobDocument:
    """Cancel a job: one that waits at once, one that runs within seconds. A second time changes nothing."""
    job = known_job(context, caller, job_id)
    outcome = context.cancel(job)
    if not isinstance(outcome, Canceled):
        raise Problem("already_finished", f"The job has {outcome.status} already: delete it to remove its files.")
    return describe(context, job)


@router.delete(
    "/{job_id}",
    status_code=204,
    response_class=Response,
    responses=_CHANGE_PROBLEMS,
)
def delete_job(job_id: JobId, context: ContextOf, caller: CallerOf) -> None:
    """Remove a job with its files; one that has not finished is canceled first."""
    job = known_job(context, caller, job_id)
    context.discard(job)
