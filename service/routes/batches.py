"""Batches: many meshes in one request, one status, one archive of results."""

from collections import Counter
from collections.abc import Callable
from contextlib import ExitStack
from typing import Annotated, Any

from fastapi import APIRouter, Path, Query, Request
from pydantic import ValidationError
from python_multipart.multipart import parse_options_header
from starlette.concurrency import run_in_threadpool
from starlette.responses import Response, StreamingResponse

from cleave.settings import LONGEST_WAIT_S
from segcore.levels import Fineness
from service.answer.archive import ZIP, batch_archive
from service.answer.level import Granularity
from service.answer.renditions import NOT_MODIFIED, answer_json
from service.answer.waiting import wait_for_end
from service.context import Context, ContextOf
from service.documents import BatchDocument, BatchedJob, BatchJobs, BatchLinks, JobDocument
from service.guard.callers import Caller, CallerOf
from service.lookup import describe_all, known_job
from service.openapi.document import PARAMETERS, ref
from service.problems import Problem, documented
from service.routes.submission import check_webhook
from service.submit.body import declared_length, pieces
from service.submit.contract import MESH_SCHEMA, PARAMETERS_IN_QUERY, SUBMISSION_PROBLEMS, ParametersInQuery, Webhook
from service.submit.form import Form, write_capped
from service.submit.intake import Wish, take_in
from service.submit.limits import check_limits
from service.submit.request import FORM_TYPE, receive_form, requested_parameters
from service.submit.zip_archive import unpack
from worker.jobs.job import Job, new_job_id, now
from worker.jobs.store.batches import Batch
from worker.jobs.store.upload import MeshUpload

router = APIRouter(prefix="/v1/batches", tags=["batches"])

BatchId = Annotated[str, Path(description="As in the answer to POST /v1/batches.")]

_JSON = "application/json"
_MAX_JSON_BYTES = 128 * 1024
_ZIPS = (ZIP, "application/x-zip-compressed")
_BODY: dict[str, Any] = {
    "parameters": [PARAMETERS_IN_QUERY],
    "requestBody": {
        "required": True,
        "content": {
            FORM_TYPE: {
                "schema": {
                    "type": "object",
                    "required": ["mesh"],
                    "additionalProperties": False,
                    "properties": {
                        "mesh": {"type": "array", "minItems": 1, "items": MESH_SCHEMA},
                        "parameters": PARAMETERS,
                    },
                },
                "encoding": {"parameters": {"contentType": _JSON}},
            },
            ZIP: {"schema": {"type": "string", "format": "binary", "description": "A ZIP archive of mesh files."}},
            _JSON: {"schema": ref(BatchJobs)},
        },
    },
}
_ACCEPTED: dict[int | str, dict[str, Any]] = {
    202: {
        "model": BatchDocument,
        "description": "All of its jobs are accepted.",
        "headers": {"Location": {"schema": {"type": "string"}, "description": "The path of the batch."}},
        "links": {
            name: {"operationId": name, "parameters": {"batch_id": "$response.body#/id"}}
            for name in ("get_batch", "get_batch_results", "delete_batch")
        },
    }
}


@router.post(
    "",
    status_code=202,
    response_class=Response,
    openapi_extra=_BODY,
    responses=_ACCEPTED | documented(*SUBMISSION_PROBLEMS, "job_not_found", "job_deleted"),
)
async def create_batch(
    request: Request,
    context: ContextOf,
    caller: CallerOf,
    parameters: ParametersInQuery = None,
    webhook: Webhook = None,
) -> Response:
    """Submit many meshes with the same parameters, or put jobs together that there are already. All or none."""
    await run_in_threadpool(context.queue.connection.ping)
    check_webhook(context, webhook)
    limits = await run_in_threadpool(check_limits, context, caller, 1, declared_length(request))
    media_type = parse_options_header(request.headers.get("content-type"))[0].decode("latin-1")
    if media_type == _JSON:
        jobs = await _named_jobs(request, context, caller)
    elif media_type == FORM_TYPE or media_type in _ZIPS:
        with ExitStack() as uploads:
            form = await _receive(
                request, context, media_type, lambda: uploads.enter_context(context.store.spool.begin_upload())
            )
            wish = Wish(parameters=requested_parameters(form.parameters, parameters), webhook_url=webhook)
            limits = await run_in_threadpool(check_limits, context, caller, len(form.meshes), declared_length(request))
            jobs = await run_in_threadpool(_take_all, context, caller, form, wish)
    else:
        raise Problem("unsupported_media_type", f"A batch is {FORM_TYPE}, {ZIP} or {_JSON}.")
    batch = Batch(id=new_job_id(), owner=caller.owner, created_at=now(), job_ids=[job.id for job in jobs])
    await run_in_threadpool(context.batches.add, batch)
    document = await run_in_threadpool(_describe, context, batch)
    return Response(
        document.model_dump_json(), 202, {"Location": document.links.self, "Retry-After": "1", **limits}, _JSON
    )


@router.get(
    "/{batch_id}",
    response_model=BatchDocument,
    responses=documented("unauthorized", "batch_not_found", "invalid_request") | {304: {"description": NOT_MODIFIED}},
)
async def get_batch(
    batch_id: BatchId,
    request: Request,
    context: ContextOf,
    caller: CallerOf,
    wait: Annotated[
        float,
        Query(
            ge=0,
            le=LONGEST_WAIT_S,
            description="Seconds to wait, if the server waits so long, for the end of its jobs.",
        ),
    ] = 0,
) -> Response:
    """How a batch is, and each of its jobs."""
    batch = await run_in_threadpool(_known_batch, context, caller, batch_id)
    began_at = now()
    most_s = min(wait, context.settings.max_wait_s)
    for job_id in batch.job_ids if wait else ():
        await wait_for_end(context.store, job_id, most_s - (now() - began_at).total_seconds())
    document = await run_in_threadpool(_describe, context, batch)
    return answer_json(request, document.model_dump_json().encode())


@router.get(
    "/{batch_id}/results.zip",
    response_class=StreamingResponse,
    responses={
        200: {
            "content": {ZIP: {"schema": {"type": "string", "format": "binary"}}},
            "description": "A folder for every job: job.json, labels.seg, hierarchy.json, model.glb.",
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
    """The results of all jobs that succeeded; where a hierarchy ends before `segments`, its last level."""
    fineness = Fineness(segments, granularity)
    batch = _known_batch(context, caller, batch_id)
    jobs = [(job, document) for job, document in _jobs(context, batch) if job and document]
    if any(document.finished_at is None for _, document in jobs):
        raise Problem("not_finished", "Some jobs of the batch have not ended: poll it until its status is finished.")
    name = {"Content-Disposition": f'attachment; filename="{batch.id}.zip"'}
    return StreamingResponse(batch_archive(context, jobs, fineness), media_type=ZIP, headers=name)


@router.delete(
    "/{batch_id}",
    status_code=204,
    response_class=Response,
    responses=documented("unauthorized", "foreign_site", "batch_not_found"),
)
def delete_batch(batch_id: BatchId, context: ContextOf, caller: CallerOf) -> None:
    """Forget that these jobs belong together; the jobs stay."""
    context.batches.delete(_known_batch(context, caller, batch_id).id)


async def _receive(request: Request, context: Context, media_type: str, begin_upload: Callable[[], MeshUpload]) -> Form:
    settings = context.settings
    if media_type == FORM_TYPE:
        return await receive_form(request, settings, begin_upload, settings.max_batch_bytes, settings.max_batch_jobs)
    with context.store.spool.begin_upload() as packed:
        async for piece in pieces(request, settings):
            await run_in_threadpool(write_capped, packed, piece, settings.max_batch_bytes)
        packed.close()
        return Form(await run_in_threadpool(unpack, packed.folder / "mesh", settings, begin_upload))


async def _named_jobs(request: Request, context: Context, caller: Caller) -> list[Job]:
    body = bytearray()
    async for piece in pieces(request, context.settings):
        body += piece
        if len(body) > _MAX_JSON_BYTES:
            raise Problem("too_large", f"The list of jobs is longer than {_MAX_JSON_BYTES} bytes.")
    try:
        wanted = BatchJobs.model_validate_json(bytes(body))
    except ValidationError as error:
        raise Problem("malformed_request", 'The body must be JSON such as {"jobs": ["<id>", "<id>"]}.') from error
    if len(wanted.jobs) > context.settings.max_batch_jobs:
        raise Problem("too_large", f"A batch has at most {context.settings.max_batch_jobs} jobs.")
    return [await run_in_threadpool(known_job, context, caller, job_id) for job_id in wanted.jobs]


def _take_all(context: Context, caller: Caller, form: Form, wish: Wish) -> list[Job]:
    if any(mesh.upload.size_bytes == 0 for mesh in form.meshes):
        raise Problem("invalid_mesh", "One of the mesh files is empty: send only files with faces.")
    made: list[Job] = []
    jobs: list[Job] = []
    try:
        for mesh in form.meshes:
            taken = take_in(context, caller, mesh, wish)
            jobs.append(taken.job)
            if taken.is_new:
                made.append(taken.job)
    except BaseException:
        for job in made:
            context.discard(job)
        raise
    return jobs


def _known_batch(context: Context, caller: Caller, batch_id: str) -> Batch:
    batch = context.batches.find(batch_id)
    if batch is None or batch.owner != caller.owner:
        raise Problem("batch_not_found", "There is no batch of this id: it was deleted, or the id is wrong.")
    return batch


def _jobs(context: Context, batch: Batch) -> list[tuple[Job | None, JobDocument | None]]:
    """The jobs of a batch in its order; None for those that were deleted."""
    found = context.store.records.jobs(batch.job_ids)
    there = [job for job in found.values() if job is not None]
    documents = {document.id: document for document in describe_all(context, there)}
    return [(found[job_id], documents.get(job_id)) for job_id in batch.job_ids]


def _describe(context: Context, batch: Batch) -> BatchDocument:
    documents = [document for _, document in _jobs(context, batch)]
    path = f"/v1/batches/{batch.id}"
    return BatchDocument(
        id=batch.id,
        status="finished" if all(one is None or one.finished_at for one in documents) else "running",
        created_at=batch.created_at,
        counts=dict(Counter("deleted" if one is None else one.status for one in documents)),
        jobs=[
            BatchedJob(
                id=job_id,
                file_name=one.input.file_name if one else None,
                status=one.status if one else "deleted",
                progress=one.progress if one else 0.0,
                error=one.error if one else None,
                self=f"/v1/jobs/{job_id}",
            )
            for job_id, one in zip(batch.job_ids, documents, strict=True)
        ],
        links=BatchLinks(self=path, results=f"{path}/results.zip"),
    )
