"""Creation of a job for an uploaded mesh; it is done at once if its mesh was segmented with the same parameters."""

import logging
from dataclasses import asdict, dataclass

from cleave.logs import about, current_traceparent
from segcore.coordinates import Axis, Unit
from segcore.parameters import SegmentationParameters
from service.context import Context
from service.guard.callers import Caller
from service.problems import Problem
from service.submit.form import ReceivedMesh
from service.submit.request import file_label, mesh_format
from worker.jobs.job import Job, new_job_id, now
from worker.jobs.queue.connection import QueueError
from worker.jobs.store.acceptance import JobExists
from worker.jobs.store.computed import fingerprint

log = logging.getLogger("cleave.intake")


@dataclass(frozen=True, slots=True, kw_only=True)
class JobRequest:
    """A validated request for a job."""

    parameters: SegmentationParameters
    mesh_format: str | None = None
    unit: Unit | None = None  # of the coordinates; None: as the file has it
    up: Axis | None = None  # the axis that points up, in the same way
    file_name: str | None = None
    webhook_url: str | None = None
    idempotency_key: str | None = None
    may_reuse: bool = True  # the result of an earlier job with the same mesh and parameters may be shared


@dataclass(frozen=True, slots=True)
class Receipt:
    """The job of a request."""

    job: Job
    is_new: bool  # not the job of an earlier request with the same Idempotency-Key
    shares_result: bool = False  # with an earlier job


def accept_job(context: Context, caller: Caller, mesh: ReceivedMesh, wanted: JobRequest) -> Receipt:
    """Accept a job into the store, and enqueue it unless the result of an earlier job is its result too.

    Raises
    ------
    Problem
        If the mesh is empty, or the Idempotency-Key belongs to another request or a deleted job.
    """
    job = _new_job(context, caller, mesh, wanted)
    if wanted.idempotency_key and context.store.deletions.was_deleted(job.id, caller.owner):
        raise Problem("idempotency_key_spent")
    shares_result = False

    def begin() -> None:
        nonlocal shares_result
        shares_result = wanted.may_reuse and context.store.finish_as_before(job)
        if not shares_result:
            _enqueue(context, job)

    with about(job.id, job.traceparent):
        try:
            context.store.accept(job, mesh.upload, begin)
        except JobExists:
            return _existing(context, job)
        log.debug("accepted", extra={"fields": {"bytes": job.size_bytes, "owner": job.owner}})
    return Receipt(job, is_new=True, shares_result=shares_result)


def _enqueue(context: Context, job: Job) -> None:
    """Enqueue a job, if its owner may have one more in the queue."""
    try:
        context.admit(job.owner, job)
    except QueueError:
        log.warning("the job could not be enqueued; the janitor will enqueue it")


def _new_job(context: Context, caller: Caller, mesh: ReceivedMesh, wanted: JobRequest) -> Job:
    upload = mesh.upload
    if upload.size_bytes == 0:
        raise Problem("invalid_mesh")
    name = wanted.file_name or mesh.file_name
    return Job(
        id=_job_id(context, caller, wanted.idempotency_key),
        sha256=upload.sha256,
        size_bytes=upload.size_bytes,
        mesh_format=None if mesh.is_set else wanted.mesh_format or mesh_format(name),
        unit=wanted.unit,
        up=wanted.up,
        parameters=asdict(wanted.parameters),
        created_at=now(),
        file_name=file_label(name),
        owner=caller.owner,
        version=context.version,
        webhook_url=wanted.webhook_url,
        traceparent=current_traceparent(),
    )


def _job_id(context: Context, caller: Caller, idempotency_key: str | None) -> str:
    """Return an id that is derived from the Idempotency-Key, so that the store itself prevents a second job."""
    if idempotency_key is None:
        return new_job_id()
    return context.secret.derive("job", caller.owner or "", idempotency_key).hex()[:32]


def _existing(context: Context, job: Job) -> Receipt:
    first = context.store.records.job(job.id)
    if first is None or fingerprint(first) != fingerprint(job):
        raise Problem("idempotency_key_reused")
    return Receipt(first, is_new=False)
