"""The submission of a batch: new meshes in a form or a ZIP archive, or the ids of existing jobs."""

from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass

from fastapi import Request
from pydantic import ValidationError
from starlette.concurrency import run_in_threadpool

from service.answer.archive import ZIP
from service.context import Context
from service.documents import BatchJobs
from service.guard.callers import Caller
from service.lookup import find_job
from service.problems import Problem
from service.submit.body import body_chunks, declared_length, media_type
from service.submit.contract import JSON
from service.submit.file_set import models_of
from service.submit.form import Form, write_capped
from service.submit.intake import JobRequest, accept_job
from service.submit.limits import check_limits
from service.submit.options import BatchOptions
from service.submit.request import FORM_TYPE, receive_form
from service.submit.submission import check_submission
from service.submit.zip_archive import extract
from worker.jobs.job import Job, new_job_id, now
from worker.jobs.store.batches import Batch
from worker.jobs.store.upload import MeshUpload

_FILES_PER_JOB = 8  # on average, at most; set by hand: a mesh, its materials and pictures
_MAX_JSON_BYTES = 128 * 1024  # of a list of jobs; set by hand
_ZIP_TYPES = (ZIP, "application/x-zip-compressed")


@dataclass(frozen=True, slots=True)
class BatchSubmission:
    """A submitted batch."""

    batch: Batch
    rate_limits: dict[str, str]  # headers of the response


async def submit_batch(request: Request, context: Context, caller: Caller, options: BatchOptions) -> BatchSubmission:
    """Accept all jobs of a batch, or none; errors as in :func:`service.submit.submission.submit_mesh`."""
    declared_bytes = declared_length(request)
    rate_limits = await run_in_threadpool(check_submission, context, caller, options.webhook, declared_bytes)
    left_out: list[str] = []
    if media_type(request) == JSON:
        jobs = await _existing_jobs(request, context, caller)
    elif media_type(request) in (FORM_TYPE, *_ZIP_TYPES):
        with ExitStack() as uploads:
            form = await _receive(request, context, lambda: uploads.enter_context(context.store.spool.begin_upload()))
            wanted, count, left_out = options.job_request(form), len(form.meshes), form.left_out
            rate_limits = await run_in_threadpool(check_limits, context, caller, count, declared_length(request))
            jobs = await run_in_threadpool(_accept_all, context, caller, form, wanted)
    else:
        raise Problem("unsupported_media_type", f"A batch is {FORM_TYPE}, {ZIP} or {JSON}.")
    batch = Batch(
        id=new_job_id(), owner=caller.owner, created_at=now(), job_ids=[job.id for job in jobs], left_out=left_out
    )
    await run_in_threadpool(context.batches.add, batch)
    return BatchSubmission(batch, rate_limits)


async def _receive(request: Request, context: Context, begin_upload: Callable[[], MeshUpload]) -> Form:
    settings = context.settings
    max_files = _FILES_PER_JOB * settings.max_batch_jobs
    if media_type(request) == FORM_TYPE:
        form = await receive_form(request, settings, begin_upload, settings.max_batch_bytes, max_files)
    else:
        with context.store.spool.begin_upload() as packed:
            async for chunk in body_chunks(request, settings):
                await run_in_threadpool(write_capped, packed, chunk, settings.max_batch_bytes)
            packed.close()
            form = Form(await run_in_threadpool(extract, packed.path, settings, begin_upload, max_files))
    most = settings.max_batch_bytes, settings.max_upload_bytes
    form.meshes, form.left_out = await run_in_threadpool(models_of, form.meshes, begin_upload, *most)
    if len(form.meshes) > settings.max_batch_jobs:
        raise Problem("too_large", f"A batch has at most {settings.max_batch_jobs} jobs: send the rest in another one.")
    return form


async def _existing_jobs(request: Request, context: Context, caller: Caller) -> list[Job]:
    body = bytearray()
    async for chunk in body_chunks(request, context.settings):
        body += chunk
        if len(body) > _MAX_JSON_BYTES:
            raise Problem("too_large", f"The list of jobs is longer than {_MAX_JSON_BYTES} bytes.")
    try:
        wanted = BatchJobs.model_validate_json(bytes(body))
    except ValidationError as error:
        raise Problem("malformed_request", 'The body must be JSON such as {"jobs": ["<id>", "<id>"]}.') from error
    if len(wanted.jobs) > context.settings.max_batch_jobs:
        raise Problem("too_large", f"A batch has at most {context.settings.max_batch_jobs} jobs.")
    return [await run_in_threadpool(find_job, context, caller, job_id) for job_id in wanted.jobs]


def _accept_all(context: Context, caller: Caller, form: Form, wanted: JobRequest) -> list[Job]:
    """Accept a job per mesh; if one is refused, delete the new jobs."""
    if any(mesh.upload.size_bytes == 0 for mesh in form.meshes):
        raise Problem("invalid_mesh", "One of the mesh files is empty: send only files with faces.")
    new_jobs: list[Job] = []
    jobs: list[Job] = []
    try:
        for mesh in form.meshes:
            receipt = accept_job(context, caller, mesh, wanted)
            jobs.append(receipt.job)
            if receipt.is_new:
                new_jobs.append(receipt.job)
    except BaseException:
        for job in new_jobs:
            context.discard(job)
        raise
    return jobs
