"""The job API: submit a mesh, poll the job, fetch its results at any number of segments."""

import io
import json
from dataclasses import asdict
from typing import Annotated, Any

from fastapi import APIRouter, Path, Query, Request
from starlette.concurrency import run_in_threadpool
from starlette.responses import Response

from segcore.io.glb import write_glb
from segcore.io.labels import hierarchy_document, labels_document
from segcore.io.result import Segmentation
from service.context import Context, ContextOf
from service.documents import HierarchyDocument, JobDocument, LabelsDocument, job_document
from service.problems import JobError, Problem, documented
from service.upload import mesh_format, parse_parameters, receive_form
from worker.jobs import Canceled, Failed, Job, Succeeded, new_job_id, now
from worker.queue import QueueError
from worker.store import UnknownJob

router = APIRouter(prefix="/v1/jobs", tags=["jobs"])

JobId = Annotated[str, Path(description="As in the answer to POST /v1/jobs.")]
Segments = Annotated[
    int | None, Query(ge=1, description="The number of segments, 1 to max_segments; by default automatic_segments.")
]
GLB = "model/gltf-binary"

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
_RESULT_PROBLEMS = documented("job_not_found", "not_finished", "job_failed", "job_canceled")
_LEVEL_PROBLEMS = documented(
    "job_not_found", "not_finished", "job_failed", "job_canceled", "invalid_parameters", "invalid_request"
)


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
    return _describe(_known(context, job_id), context)


@router.post(
    "/{job_id}/cancel",
    response_model=JobDocument,
    responses=documented("job_not_found", "already_finished", "storage_full"),
)
def cancel_job(job_id: JobId, context: ContextOf) -> JobDocument:
    """Cancel a job: one that waits at once, one that runs within seconds. A second time changes nothing."""
    job = _known(context, job_id)
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
    job = _known(context, job_id)
    context.store.finish(job.id, Canceled(finished_at=now()))
    context.store.delete(job.id)
    context.results.drop(job.id)
    _forget(context, job.id)


@router.get(
    "/{job_id}/labels",
    response_class=Response,
    responses={200: {"model": LabelsDocument, "description": "The labels."}, **_LEVEL_PROBLEMS},
)
def get_labels(job_id: JobId, context: ContextOf, segments: Segments = None) -> Response:
    """The segment of every face, in the order of the file, at any number of segments."""
    return _json(labels_document(_result(context, job_id).hierarchy, segments))


@router.get(
    "/{job_id}/hierarchy",
    response_class=Response,
    responses={200: {"model": HierarchyDocument, "description": "The tree of cuts."}, **_RESULT_PROBLEMS},
)
def get_hierarchy(job_id: JobId, context: ContextOf) -> Response:
    """The tree of cuts from which every number of segments is read."""
    return _json(hierarchy_document(_result(context, job_id).hierarchy))


@router.get(
    "/{job_id}/model.glb",
    response_class=Response,
    responses={200: {"content": {GLB: {}}, "description": "A node and a colour per segment."}, **_LEVEL_PROBLEMS},
)
def get_model(job_id: JobId, context: ContextOf, segments: Segments = None) -> Response:
    """The mesh as binary glTF, a named node and a colour for every segment, at any number of segments."""
    result, target = _result(context, job_id), io.BytesIO()
    write_glb(target, result.mesh, result.hierarchy, segments)
    return Response(
        target.getvalue(), headers={"Content-Disposition": f'attachment; filename="{job_id}.glb"'}, media_type=GLB
    )


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


def _known(context: Context, job_id: str) -> Job:
    job = context.store.job(job_id)
    if job is None:
        raise UnknownJob(job_id)
    return job


def _describe(job: Job, context: Context) -> JobDocument:
    outcome = context.store.outcome(job.id)
    activity = None if outcome else context.view.activity(job.id)
    return job_document(job, outcome, context.store.attempts(job.id), activity)


def _result(context: Context, job_id: str) -> Segmentation:
    job = _known(context, job_id)
    match context.store.outcome(job.id):
        case Succeeded():
            return context.results.get(job.id)
        case Failed(code=code, message=message):
            raise Problem("job_failed", f"The job failed: {message}", JobError(code=code, message=message))
        case Canceled():
            raise Problem("job_canceled", "The job was canceled and has no result: submit the mesh again.")
        case None:
            raise Problem("not_finished", "The job has not finished: poll it until its status is succeeded.")


def _json(document: dict[str, Any]) -> Response:
    body = json.dumps(document, allow_nan=False, separators=(",", ":"))
    return Response(body, media_type="application/json")
