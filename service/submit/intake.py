"""A received mesh becomes a job: a new one, or the one that has computed the same before."""

import logging
from dataclasses import asdict, dataclass

from cleave.logs import about, current_traceparent
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
class Wish:
    """What a client wants done with a mesh."""

    parameters: SegmentationParameters
    mesh_format: str | None = None
    file_name: str | None = None
    webhook_url: str | None = None
    idempotency_key: str | None = None
    may_reuse: bool = True  # a result that was computed before will do


@dataclass(frozen=True, slots=True)
class Taken:
    """The job that a client gets."""

    job: Job
    is_new: bool


def take_in(context: Context, caller: Caller, received: ReceivedMesh, wish: Wish) -> Taken:
    """Accept a mesh into the store and let it wait.

    Raises
    ------
    Problem
        Where the mesh is empty, or the Idempotency-Key stands for another request or a deleted job.
    """
    job = _candidate(context, caller, received, wish)
    if wish.may_reuse and not (wish.idempotency_key and context.store.records.job(job.id)):
        known = context.store.computed_before(job)
        if known is not None:
            return Taken(known, is_new=False)
    if wish.idempotency_key and context.store.deletions.was_deleted(job.id, caller.owner):
        raise Problem("idempotency_key_spent", "The job of this Idempotency-Key was deleted: use another key.")
    try:
        context.store.accept(job, received.upload)
    except JobExists:
        return _replayed(context, job)
    with about(job.id, job.traceparent):
        log.info("accepted", extra={"fields": {"bytes": job.size_bytes, "owner": job.owner}})
        enqueue(context, job)
    return Taken(job, is_new=True)


def enqueue(context: Context, job: Job) -> None:
    """Let a job into the queue as far as its owner may have jobs there."""
    try:
        context.admit(job.owner, job)
    except QueueError:
        log.warning("the queue did not take the job; the janitor will see to it")


def _candidate(context: Context, caller: Caller, received: ReceivedMesh, wish: Wish) -> Job:
    upload = received.upload
    if upload.size_bytes == 0:
        raise Problem("invalid_mesh", "The mesh file is empty: send one with faces.")
    name = wish.file_name or received.file_name
    return Job(
        id=_job_id(context, caller, wish.idempotency_key),
        sha256=upload.sha256,
        size_bytes=upload.size_bytes,
        mesh_format=wish.mesh_format or mesh_format(name),
        parameters=asdict(wish.parameters),
        created_at=now(),
        file_name=file_label(name),
        owner=caller.owner,
        version=context.version,
        webhook_url=wish.webhook_url,
        traceparent=current_traceparent(),
    )


def _job_id(context: Context, caller: Caller, idempotency_key: str | None) -> str:
    """The same for the same key of the same caller, so that the store itself keeps a second job from being made."""
    if idempotency_key is None:
        return new_job_id()
    return context.secret.derive("job", caller.owner or "", idempotency_key).hex()[:32]


def _replayed(context: Context, job: Job) -> Taken:
    first = context.store.records.job(job.id)
    if first is None or fingerprint(first) != fingerprint(job):
        raise Problem(
            "idempotency_key_reused",
            "This Idempotency-Key was sent with another mesh or other parameters: use a new key.",
        )
    return Taken(first, is_new=False)
