"""Jobs: list, poll, events, cancel and delete."""

from typing import Annotated

from fastapi import APIRouter, Header, Query, Request
from starlette.concurrency import run_in_threadpool
from starlette.responses import Response, StreamingResponse

from cleave.settings import LONGEST_WAIT_S
from service.answer.events import EVENT_SCHEMA, has_last_event, job_events
from service.answer.renditions import NOT_MODIFIED, answer_json
from service.answer.waiting import wait_for_end
from service.context import ContextOf
from service.guard.callers import CallerOf
from service.job_documents import JobDocument, JobPageDocument, Status
from service.lookup import JOB_PROBLEMS, JobId, describe, describe_all, find_job
from service.problems import Problem, documented
from worker.jobs.job import Canceled
from worker.jobs.store.index import CURSOR

router = APIRouter(prefix="/v1/jobs", tags=["jobs"])

_CHANGE_PROBLEMS = (*JOB_PROBLEMS, "foreign_site", "insufficient_storage")

# nginx would otherwise collect events before it sends them on.
_STREAM_HEADERS = {"Cache-Control": "no-store", "X-Accel-Buffering": "no"}

Wait = Annotated[
    float,
    Query(ge=0, le=LONGEST_WAIT_S, description="Seconds to wait for the end of the job, up to a limit of the server."),
]


@router.get(
    "",
    response_model=JobPageDocument,
    responses=documented("unauthorized", "invalid_request") | {304: {"description": NOT_MODIFIED}},
)
def list_jobs(
    request: Request,
    context: ContextOf,
    caller: CallerOf,
    limit: Annotated[int, Query(ge=1, le=200, description="The maximum number of jobs on a page.")] = 50,
    cursor: Annotated[
        str | None, Query(pattern=CURSOR, description="The next_cursor of the previous page; none for the first page.")
    ] = None,
    status: Annotated[Status | None, Query(description="Only jobs with this status.")] = None,
) -> Response:
    """The jobs, newest first."""
    page = context.store.page(caller.owner, cursor, limit)
    jobs = [job for job in describe_all(context, page.jobs) if status in (None, job.status)]
    document = JobPageDocument(jobs=jobs, next_cursor=page.next_cursor)
    return answer_json(request, document.model_dump_json().encode())


@router.get(
    "/{job_id}",
    response_model=JobDocument,
    responses=documented(*JOB_PROBLEMS, "invalid_request") | {304: {"description": NOT_MODIFIED}},
)
async def get_job(job_id: JobId, request: Request, context: ContextOf, caller: CallerOf, wait: Wait = 0) -> Response:
    """The state of a job. With ``wait`` the response is sent when the job has ended, or after so many seconds."""
    if wait:
        job = await run_in_threadpool(find_job, context, caller, job_id)
        await wait_for_end(context.store, context.endings, job.id, min(wait, context.settings.max_wait_s))
    document = await run_in_threadpool(lambda: describe(context, find_job(context, caller, job_id)))
    retry = {} if document.finished_at else {"Retry-After": "1"}
    return answer_json(request, document.model_dump_json().encode(), headers=retry)


@router.get(
    "/{job_id}/events",
    response_class=StreamingResponse,
    responses={
        200: {
            "description": "A stream of events `status`, each with a job document as its data. The last one reports "
            "the end of the job.",
            "content": {"text/event-stream": {"schema": EVENT_SCHEMA}},
        },
        204: {"description": "The job has ended and Last-Event-ID is that of the last event: do not reconnect."},
        **documented(*JOB_PROBLEMS, "invalid_request"),
    },
)
async def get_events(
    job_id: JobId,
    context: ContextOf,
    caller: CallerOf,
    last_event_id: Annotated[
        int, Header(ge=0, le=2**53, description="The id of the last event that the client has received.")
    ] = 0,
) -> Response:
    """The changes of a job as server-sent events."""
    job = await run_in_threadpool(find_job, context, caller, job_id)
    if has_last_event(await run_in_threadpool(describe, context, job), last_event_id):
        return Response(status_code=204)
    stream = job_events(context, job, last_event_id)
    return StreamingResponse(stream, media_type="text/event-stream", headers=_STREAM_HEADERS)


@router.post(
    "/{job_id}/cancel",
    response_model=JobDocument,
    responses=documented(*_CHANGE_PROBLEMS, "already_finished"),
)
def cancel_job(job_id: JobId, context: ContextOf, caller: CallerOf) -> JobDocument:
    """Cancel a job: a waiting one at once, a running one within seconds. Canceling it again has no effect."""
    job = find_job(context, caller, job_id)
    outcome = context.cancel(job)
    if not isinstance(outcome, Canceled):
        raise Problem("already_finished", f"The job has already {outcome.status}: delete it to remove its files.")
    return describe(context, job)


@router.delete(
    "/{job_id}",
    status_code=204,
    response_class=Response,
    responses=documented(*_CHANGE_PROBLEMS),
)
def delete_job(job_id: JobId, context: ContextOf, caller: CallerOf) -> None:
    """Delete a job and its files; an unfinished job is canceled first."""
    context.discard(find_job(context, caller, job_id))
