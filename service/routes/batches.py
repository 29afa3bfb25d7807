"""Batches: many meshes in one request, with one status and one archive of results."""

from typing import Annotated

from fastapi import APIRouter, Path, Query, Request
from starlette.concurrency import run_in_threadpool
from starlette.responses import Response, StreamingResponse

from cleave.settings import LONGEST_WAIT_S
from segcore.levels import Fineness
from service.answer.archive import ZIP, batch_archive
from service.answer.level import Granularity
from service.answer.renditions import NOT_MODIFIED, answer_json
from service.answer.waiting import wait_for_end
from service.context import Context, ContextOf
from service.documents import BatchDocument
from service.guard.callers import CallerOf
from service.lookup import describe_batch, ended_jobs, find_batch
from service.problems import documented
from service.submit.batch import submit_batch
from service.submit.contract import BATCH_BODY, BATCH_RESPONSES, JSON, SUBMISSION_PROBLEMS
from service.submit.options import BatchOptionsOf
from worker.jobs.job import now
from worker.jobs.store.batches import Batch

router = APIRouter(prefix="/v1/batches", tags=["batches"])

BatchId = Annotated[str, Path(description="As in the response to POST /v1/batches.")]
Wait = Annotated[
    float,
    Query(ge=0, le=LONGEST_WAIT_S, description="Seconds to wait for the end of its jobs, up to a limit of the server."),
]


@router.post(
    "",
    status_code=202,
    response_class=Response,
    openapi_extra=BATCH_BODY,
    responses=BATCH_RESPONSES | documented(*SUBMISSION_PROBLEMS, "job_not_found", "job_deleted"),
)
async def create_batch(request: Request, context: ContextOf, caller: CallerOf, options: BatchOptionsOf) -> Response:
    """Submit many meshes with the same parameters, or combine existing jobs. All are accepted, or none."""
    submission = await submit_batch(request, context, caller, options)
    document = await run_in_threadpool(describe_batch, context, submission.batch)
    headers = {"Location": document.links.self, "Retry-After": "1", **submission.rate_limits}
    return Response(document.model_dump_json(), 202, headers, JSON)


@router.get(
    "/{batch_id}",
    response_model=BatchDocument,
    responses=documented("unauthorized", "batch_not_found", "invalid_request") | {304: {"description": NOT_MODIFIED}},
)
async def get_batch(
    batch_id: BatchId, request: Request, context: ContextOf, caller: CallerOf, wait: Wait = 0
) -> Response:
    """The state of a batch and of each of its jobs."""
    batch = await run_in_threadpool(find_batch, context, caller, batch_id)
    await _wait_for_jobs(context, batch, min(wait, context.settings.max_wait_s))
    document = await run_in_threadpool(describe_batch, context, batch)
    return answer_json(request, document.model_dump_json().encode())


@router.get(
    "/{batch_id}/results.zip",
    response_class=StreamingResponse,
    responses={
        200: {
            "content": {ZIP: {"schema": {"type": "string", "format": "binary"}}},
            "description": "A folder per job: job.json, labels.seg, hierarchy.json, model.glb.",
        },
        **documented("unauthorized", "batch_not_found", "not_finished", "invalid_request", "invalid_parameters"),
    },
)
def get_batch_results(
    batch_id: BatchId,
    context: ContextOf,
    caller: CallerOf,
    segments: Annotated[int | None, Query(ge=1, description="The number of segments; by default automatic.")] = None,
    granularity: Granularity = None,
) -> StreamingResponse:
    """The results of all jobs that succeeded; of a hierarchy with fewer than `segments` segments, the last level."""
    fineness = Fineness(segments, granularity)
    batch = find_batch(context, caller, batch_id)
    archive = batch_archive(context, ended_jobs(context, batch), fineness)
    name = {"Content-Disposition": f'attachment; filename="{batch.id}.zip"'}
    return StreamingResponse(archive, media_type=ZIP, headers=name)


@router.delete(
    "/{batch_id}",
    status_code=204,
    response_class=Response,
    responses=documented("unauthorized", "foreign_site", "batch_not_found"),
)
def delete_batch(batch_id: BatchId, context: ContextOf, caller: CallerOf) -> None:
    """Delete a batch but not its jobs."""
    context.batches.delete(find_batch(context, caller, batch_id).id)


async def _wait_for_jobs(context: Context, batch: Batch, at_most_s: float) -> None:
    began_at = now()
    for job_id in batch.job_ids if at_most_s else ():
        await wait_for_end(context.store, context.endings, job_id, at_most_s - (now() - began_at).total_seconds())
