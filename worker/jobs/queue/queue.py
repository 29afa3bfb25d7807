"""The queue of jobs in Redis: which jobs wait, which worker runs which job, and the progress of those that run.

A waiting job is an entry in an rq queue, of which there is one for small jobs and one for large ones. A running job has
a lease, a key that its worker renews and that Redis removes if the worker no longer does. Only job ids, names of stages
and numbers are kept in Redis, and the store can restore all of them.
"""

import json
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from redis import Redis
from rq import Queue
from rq.exceptions import DuplicateJobError
from rq.intermediate_queue import IntermediateQueue
from rq.job import Job as Entry
from rq.serializers import JSONSerializer

from worker.jobs.queue.compilation import KEY as COMPILATION_KEY
from worker.jobs.queue.compilation import Compilation, compilation_from
from worker.jobs.queue.connection import milliseconds, text_of
from worker.jobs.queue.entries import FUNCTION_NAME
from worker.jobs.size_class import SizeClass

QUEUE_NAMES = {size: f"cleave:{size}" for size in SizeClass}

ENDINGS_CHANNEL = "cleave:ended"  # of announcements with the id of a job that has ended
_PROGRESS_TTL_S = 24 * 3600  # longer than a job may run by default (CLEAVE_JOB_TIMEOUT_S)
_NO_TIMEOUT = -1  # rq's value; the worker process has its own timeout


@dataclass(frozen=True, slots=True)
class Progress:
    stage: str
    fraction: float  # 0..1 of the whole job


@dataclass(frozen=True, slots=True)
class Activity:
    """The state of an unfinished job in the queue."""

    running: bool
    progress: Progress | None
    position: int | None = None  # 1 is next; None if it does not wait in the queue
    compilation: Compilation | None = None  # for which the job waits, at the first start of an installation


class JobQueue:
    """The waiting jobs and the leases of the running ones."""

    def __init__(self, connection: Redis) -> None:
        self.connection = connection
        self.entries = {
            size: Queue(name, connection=connection, serializer=JSONSerializer) for size, name in QUEUE_NAMES.items()
        }
        self._waiting_keys = [entries.key for entries in self.entries.values()]
        self._intermediate_keys = [IntermediateQueue.get_intermediate_queue_key(key) for key in self._waiting_keys]

    def enqueue(self, job_id: str, size: SizeClass, *, at_front: bool = False) -> None:
        """Add a job to the queue of its size, unless it is waiting already."""
        with suppress(DuplicateJobError), self.connection.pipeline(transaction=False) as afterwards:
            self.entries[size].enqueue(
                FUNCTION_NAME,
                job_id,
                job_id=job_id,
                unique=True,
                at_front=at_front,
                job_timeout=_NO_TIMEOUT,
                result_ttl=0,
                pipeline=afterwards,  # for the name of the queue; the entry is added by a script of its own
            )
            afterwards.execute()

    def requeue(self, job_id: str, size: SizeClass, *, at_front: bool = False) -> None:
        """Add a job to the queue of its size, in place of any earlier entry of it."""
        self.forget(job_id)
        self.enqueue(job_id, size, at_front=at_front)

    def forget(self, job_id: str) -> None:
        """Remove the entry of a job and its progress."""
        with self.connection.pipeline() as transaction:
            for key in (*self._waiting_keys, *self._intermediate_keys):
                transaction.lrem(key, 0, job_id)
            transaction.delete(Entry.key_for(job_id), _progress_key(job_id))
            transaction.execute()

    def take(self, job_id: str, worker: str, lease_s: float) -> bool:
        """Acquire the lease of a job that was dequeued; False if another worker holds it."""
        with self.connection.pipeline() as transaction:
            transaction.set(_lease_key(job_id), worker, nx=True, px=milliseconds(lease_s))
            for key in self._intermediate_keys:
                transaction.lrem(key, 0, job_id)
            return bool(transaction.execute()[0])

    def renew(self, job_id: str, worker: str, lease_s: float) -> None:
        """Renew a lease, or restore it if Redis has lost it."""
        self.connection.set(_lease_key(job_id), worker, px=milliseconds(lease_s))

    def release(self, job_id: str, worker: str) -> None:
        """Release a lease, unless another worker holds it now."""
        if self.connection.get(_lease_key(job_id)) == worker.encode():
            self.connection.delete(_lease_key(job_id))

    def held(self, job_ids: Iterable[str]) -> set[str]:
        """Return those of the jobs that wait or run, read in one transaction."""
        ids = list(job_ids)
        if not ids:
            return set()
        with self.connection.pipeline() as transaction:
            for job_id in ids:
                transaction.exists(_lease_key(job_id))
                for key in self._waiting_keys:
                    transaction.lpos(key, job_id)
            replies = iter(transaction.execute())
        each = zip(*(replies for _ in range(1 + len(self._waiting_keys))), strict=True)
        return {
            job_id
            for job_id, (lease, *indices) in zip(ids, each, strict=True)
            if lease or any(index is not None for index in indices)
        }

    def waiting(self) -> set[str]:
        """Return all jobs that wait."""
        with self.connection.pipeline() as transaction:
            for key in self._waiting_keys:
                transaction.lrange(key, 0, -1)
            return {text_of(job_id) for entries in transaction.execute() for job_id in entries}

    def publish(self, job_id: str, progress: Progress) -> None:
        document = json.dumps({"stage": progress.stage, "fraction": progress.fraction})
        self.connection.set(_progress_key(job_id), document, ex=_PROGRESS_TTL_S)

    def announce_end(self, job_id: str) -> None:
        """Tell the services that a job has an outcome now."""
        self.connection.publish(ENDINGS_CHANNEL, job_id)

    def activities(self, job_ids: Iterable[str]) -> dict[str, Activity]:
        """Return the states of some unfinished jobs, by their ids."""
        ids = list(job_ids)
        with self.connection.pipeline(transaction=False) as pipeline:
            for job_id in ids:
                pipeline.mget(_lease_key(job_id), _progress_key(job_id), COMPILATION_KEY)
                for key in self._waiting_keys:
                    pipeline.lpos(key, job_id)
            replies = pipeline.execute()
        each = 1 + len(self._waiting_keys)
        indices = zip(*(replies[1 + number :: each] for number in range(each - 1)), strict=True)
        return {
            job_id: _activity(lease, document, found, compilation)
            for job_id, (lease, document, compilation), found in zip(ids, replies[::each], indices, strict=True)
        }

    def activity(self, job_id: str) -> Activity:
        return self.activities([job_id])[job_id]

    def lengths(self) -> dict[SizeClass, int]:
        """Return the number of jobs that wait in each queue."""
        return {size: int(self.connection.llen(entries.key)) for size, entries in self.entries.items()}

    def ages_s(self, at: datetime) -> dict[SizeClass, float]:
        """Return for how many seconds the next job of each queue has been waiting; 0 if none waits."""
        heads = {size: self.connection.lindex(entries.key, 0) for size, entries in self.entries.items()}
        since = {
            size: self.connection.hget(Entry.key_for(text_of(job_id)), "enqueued_at") if job_id else None
            for size, job_id in heads.items()
        }
        return {
            size: max(0.0, (at - datetime.fromisoformat(text_of(time))).total_seconds()) if time else 0.0
            for size, time in since.items()
        }

    def running(self) -> list[str]:
        """Return the jobs that have a lease; this scans all keys of Redis."""
        prefix = _lease_key("")
        return [key.decode().removeprefix(prefix) for key in self.connection.scan_iter(f"{prefix}*", count=1000)]


def _lease_key(job_id: str) -> str:
    return f"cleave:lease:{job_id}"


def _progress_key(job_id: str) -> str:
    return f"cleave:progress:{job_id}"


def _activity(
    lease: bytes | None, document: bytes | None, indices: tuple[int | None, ...], compilation: bytes | None
) -> Activity:
    if lease:
        return Activity(running=True, progress=_progress(document) if document else None)
    position = next((index + 1 for index in indices if index is not None), None)
    return Activity(running=False, progress=None, position=position, compilation=compilation_from(compilation))


def _progress(document: bytes) -> Progress:
    values: dict[str, Any] = json.loads(document)
    return Progress(stage=str(values["stage"]), fraction=float(values["fraction"]))
