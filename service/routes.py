"""The job API: submit a mesh, poll the job, cancel it, delete it."""

from dataclasses import asdict
from typing import Annotated, Any

from fastapi import APIRouter, Path, Request
from starlette.concurrency import run_in_threadpool
from starlette.responses import Response

from service.context import Context, ContextOf
from service.documents import JobDocument, job_document
from service.problems import Problem, documented
from service.upload import mesh_format, parse_parameters, receive_form
from worker.jobs import Canceled, Job, new_job_id, now
from worker.queue import QueueError
from worker.store import UnknownJob

router = APIRouter(prefix="/v1/jobs", tags=["jobs"])

JobId = Annotated[str, Path(description="As in the answer to POST /v1/jobs.")]

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
    return job_document(job, None, [], None)


@router.get("/{job_id}", response_model=JobDocument, responses=documented("job_not_found"))
def get_job(job_id: JobId, context: ContextOf) -> JobDocument:
    """How a job is."""
    return _describe(known_job(context, job_id), context)


@router.post(
    "/{job_id}/cancel",
    response_model=JobDocument,
    responses=documented("job_not_found", "already_finished", "storage_full"),
)
def cancel_job(job_id: JobId, context: ContextOf) -> JobDocument:
    """Cancel a job: one that waits at once, one that runs within seconds. A second time changes nothing."""
    job = known_job(context, job_id)
    outcome = context.store.finish(job.id, Canceled(finished_at=now()))
    if not isinstance(outcome, Canceled):
        raise Problem("already_finished", f"The job has {outcome.status} already: delete it to remove its files.")
    _forget(context, job.id)
    return _describe(job, context)


@router.delete(
    "/{job_id}", status_code=204, response_class=Response, responses=documented("job_not_found", "storage_full")
)
def delete_job(job_id: JobId, context: ContextOf) -> None:
    """Remove a job with its files; one that has not finished is canceled first."""
    job = known_job(context, job_id)
    context.store.finish(job.id, Canceled(finished_at=now()))
    context.store.delete(job.id)
    context.results.drop(job.id)
    _forget(context, job.id)


def known_job(context: Context, job_id: str) -> Job:
    """The record of a job.

    Raises
    ------
    UnknownJob
        Where there is none.
    """
    job = context.store.job(job_id)
    if job is None:
        raise UnknownJob(job_id)
    return job


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


def _describe(job: Job, context: Context) -> JobDocument:
    outcome = context.store.outcome(job.id)
    activity = None if outcome else context.view.activity(job.id)
    return job_document(job, outcome, context.store.attempts(job.id), activity)
