"""The submission of one mesh: checks, upload and acceptance."""

from contextlib import ExitStack
from dataclasses import dataclass

from fastapi import Request
from starlette.concurrency import run_in_threadpool

from cleave.logs import note_job
from segcore.errors import InvalidParameters
from segcore.levels import Fineness
from service.context import Context
from service.guard.callers import Caller
from service.submit.body import declared_length
from service.submit.form import ReceivedMesh
from service.submit.intake import JobRequest, Receipt, accept_job
from service.submit.limits import check_limits
from service.submit.options import JobOptions
from service.submit.request import receive_mesh, requested_format
from worker.webhooks.message import objection_to


@dataclass(frozen=True, slots=True)
class Submission:
    """A submitted mesh."""

    receipt: Receipt
    fineness: Fineness  # of the labels in the response
    rate_limits: dict[str, str]  # headers of the response


async def submit_mesh(request: Request, context: Context, caller: Caller, options: JobOptions) -> Submission:
    """Accept the mesh of a request.

    Raises
    ------
    QueueError
        If Redis does not answer. This is checked before the upload: without it no job runs, and unbounded uploads
        would fill the disk. Once a job is stored, it is accepted, and the janitor enqueues it if necessary.
    InvalidParameters, Problem
        If the request is not valid or exceeds a limit.
    """
    fineness, mesh_format = options.fineness(), requested_format(request, options.format)
    declared_bytes = declared_length(request)
    rate_limits = await run_in_threadpool(check_submission, context, caller, options.webhook, declared_bytes)
    with ExitStack() as uploads:
        form = await receive_mesh(
            request, context.settings, lambda: uploads.enter_context(context.store.spool.begin_upload())
        )
        wanted = options.job_request(form, mesh_format)
        receipt = await run_in_threadpool(_accept, context, caller, form.meshes[0], wanted)
    return Submission(receipt, fineness, rate_limits)


def check_submission(context: Context, caller: Caller, webhook: str | None, declared_bytes: int) -> dict[str, str]:
    """Check the service and the limits for one job; return the headers, and raise what these checks raise."""
    check_service(context, webhook)
    return check_limits(context, caller, 1, declared_bytes)


def check_service(context: Context, webhook: str | None) -> None:
    """Check that the queue is available and that a webhook may be called.

    Raises
    ------
    QueueError
        If Redis does not answer.
    InvalidParameters
        If messages may not be sent to the URL.
    """
    context.queue.connection.ping()
    objection = None if webhook is None else objection_to(webhook, context.settings.webhook_private_targets)
    if objection:
        raise InvalidParameters(objection)


def _accept(context: Context, caller: Caller, mesh: ReceivedMesh, wanted: JobRequest) -> Receipt:
    receipt = accept_counted(context, caller, mesh, wanted)
    context.metrics.upload_bytes.inc(mesh.upload.size_bytes)
    if context.settings.key_upload_bytes_per_hour is not None:
        context.quota.add(caller.owner, mesh.upload.size_bytes)
    return receipt


def accept_counted(context: Context, caller: Caller, mesh: ReceivedMesh, wanted: JobRequest) -> Receipt:
    """Accept a job, and note it in the log and the metrics; errors as in :func:`accept_job`."""
    receipt = accept_job(context, caller, mesh, wanted)
    note_job(receipt.job.id)
    context.metrics.jobs.labels("accepted" if receipt.is_new and not receipt.shares_result else "reused").inc()
    return receipt
