"""A job with the mesh of an earlier job and other parameters."""

import shutil

from fastapi import Request
from starlette.concurrency import run_in_threadpool

from segcore.coordinates import axis_named, unit_named
from segcore.errors import InvalidParameters
from segcore.levels import Fineness
from segcore.parameters import SegmentationParameters
from service.context import Context
from service.guard.callers import Caller
from service.problems import Problem
from service.submit.body import body_chunks
from service.submit.form import MAX_PARAMETERS_BYTES, ReceivedMesh
from service.submit.intake import JobRequest, Receipt
from service.submit.limits import check_limits
from service.submit.options import RerunOptions, may_reuse
from service.submit.request import parse_parameters
from service.submit.submission import Submission, accept_counted, check_service
from worker.jobs.job import Job


async def submit_again(
    request: Request, context: Context, caller: Caller, job: Job, options: RerunOptions
) -> Submission:
    """Accept a job with the mesh of an earlier one and the parameters in the body.

    Raises
    ------
    QueueError
        If Redis does not answer.
    InvalidParameters, Problem
        If the request is not valid or exceeds a limit, or the store no longer has the mesh.
    """
    await run_in_threadpool(check_service, context, options.webhook)
    parameters = parse_parameters(await _parameters_text(request, context))
    rate_limits = await run_in_threadpool(check_limits, context, caller, 1, 0)
    receipt = await run_in_threadpool(_accept, context, caller, job, _request(job, parameters, options))
    return Submission(receipt, Fineness(), rate_limits)


async def _parameters_text(request: Request, context: Context) -> bytes:
    text = b""
    async for chunk in body_chunks(request, context.settings):
        text += chunk
        if len(text) > MAX_PARAMETERS_BYTES:
            raise InvalidParameters(f"The parameters have more than {MAX_PARAMETERS_BYTES} bytes.")
    return text


def _request(job: Job, parameters: SegmentationParameters, options: RerunOptions) -> JobRequest:
    return JobRequest(
        parameters=parameters,
        mesh_format=job.mesh_format,
        unit=None if job.unit is None else unit_named(job.unit),
        up=None if job.up is None else axis_named(job.up),
        file_name=job.file_name,
        webhook_url=options.webhook,
        idempotency_key=options.idempotency_key,
        may_reuse=may_reuse(options.cache_control),
    )


def _accept(context: Context, caller: Caller, job: Job, wanted: JobRequest) -> Receipt:
    try:
        source = context.store.open_mesh(job.id)
    except FileNotFoundError:
        raise Problem("input_lost") from None
    with source, context.store.spool.begin_upload() as upload:
        shutil.copyfileobj(source, upload)
        # Without a declared format it is detected from the bytes, as it was for the earlier job.
        return accept_counted(
            context, caller, ReceivedMesh(upload, job.file_name, is_set=job.mesh_format is None), wanted
        )
