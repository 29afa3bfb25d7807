"""The queue: which job is next, which worker holds which job, how far it is; the store can make all of it again.

A waiting job is an entry in an rq queue; small jobs and large ones have one each. A running job has a lease, a key that
its worker renews and that Redis drops when the worker falls silent. Only job ids, stage names and numbers pass through
Redis.
"""

import json
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from redis import Redis
from redis.backoff import ExponentialBackoff, NoBackoff
from redis.exceptions import RedisError
from redis.retry import Retry
from rq import Queue
from rq.exceptions import DuplicateJobError
from rq.intermediate_queue import IntermediateQueue
from rq.job import Job as Entry
from rq.serializers import JSONSerializer
from rq.worker_registration import WORKERS_BY_QUEUE_KEY, clean_worker_registry

from worker.jobs.size_class import SizeClass

QUEUE_NAMES = {size: f"cleave:{size}" for size in SizeClass}
TASK = "worker.tasks.perform"  # the only callable that an entry may name

QueueError = RedisError

_LEADER_KEY = "cleave:janitor"
_PROGRESS_TTL_S = 24 * 3600
_FOR_EVER = -1


@dataclass(frozen=True, slots=True)
class Progress:
    stage: str
    fraction: float  # 0..1 of the whole job


@dataclass(frozen=True, slots=True)
class Activity:
    """What the queue knows about an unfinished job."""

    running: bool
    progress: Progress | None
    position: int | None = None  # 1 is next; None where it does not wait in the queue


def connect_impatiently(url: str, timeout_s: float = 0.9) -> Redis:
    """A connection for callers that have something better to do than to wait: an error within about two timeouts."""
    return Redis.from_url(url, socket_timeout=timeout_s, socket_connect_timeout=timeout_s, retry=Retry(NoBackoff(), 1))


def connect_patiently(url: str) -> Redis:
    """A connection for the loop of a worker, which has nothing to do without the queue: it rides out minutes."""
    return Redis.from_url(
        url,
        socket_timeout=30.0,
        socket_connect_timeout=5.0,
        health_check_interval=30,
        retry=Retry(ExponentialBackoff(cap=2.0, base=0.1), 150),
    )


class JobQueue:
    """The jobs that wait and the leases of those that run."""

    def __init__(self, connection: Redis) -> None:
        self.connection = connection
        self.entries = {
            size: Queue(name, connection=connection, serializer=JSONSerializer) for size, name in QUEUE_NAMES.items()
        }
        self._waiting_keys = [entries.key for entries in self.entries.values()]
        self._taken_keys = [IntermediateQueue.get_intermediate_queue_key(key) for key in self._waiting_keys]

    def enqueue(self, job_id: str, size: SizeClass, *, at_front: bool = False) -> None:
        """Let a job wait for a worker; without effect where it waits already."""
        with suppress(DuplicateJobError):
            self.entries[size].enqueue(
                TASK, job_id, job_id=job_id, unique=True, at_front=at_front, job_timeout=_FOR_EVER, result_ttl=0
            )

    def requeue(self, job_id: str, size: SizeClass, *, at_front: bool = False) -> None:
        """Let a job wait for a worker whatever is left of an earlier entry."""
        self.forget(job_id)
        self.enqueue(job_id, size, at_front=at_front)

    def forget(self, job_id: str) -> None:
        """Remove the entry of a job and its progress."""
        with self.connection.pipeline() as transaction:
            for key in (*self._waiting_keys, *self._taken_keys):
                transaction.lrem(key, 0, job_id)
            transaction.delete(Entry.key_for(job_id), _progress_key(job_id))
            transaction.execute()

    def take(self, job_id: str, worker: str, lease_s: float) -> bool:
        """Begin to hold a job that was dequeued; False where another worker holds it."""
        with self.connection.pipeline() as transaction:
            transaction.set(_lease_key(job_id), worker, nx=True, px=_milliseconds(lease_s))
            for key in self._taken_keys:
                transaction.lrem(key, 0, job_id)
            return bool(transaction.execute()[0])

    def renew(self, job_id: str, worker: str, lease_s: float) -> None:
        """Go on holding a job, also where the lease was wiped."""
        self.connection.set(_lease_key(job_id), worker, px=_milliseconds(lease_s))

    def release(self, job_id: str, worker: str) -> None:
        """End a lease, unless another worker has it by now."""
        if self.connection.get(_lease_key(job_id)) == worker.encode():
            self.connection.delete(_lease_key(job_id))

    def held(self, job_ids: Iterable[str]) -> set[str]:
        """Those of the jobs that wait or run, at one moment."""
        asked = list(job_ids)
        with self.connection.pipeline() as transaction:
            for job_id in asked:
                transaction.exists(_lease_key(job_id))
            for key in self._waiting_keys:
                transaction.lrange(key, 0, -1)
            answers = transaction.execute()
        running = {job_id for job_id, lease in zip(asked, answers, strict=False) if lease}
        waiting = {entry.decode() for entries in answers[len(asked) :] for entry in entries}
        return running | (waiting & set(asked))

    def publish(self, job_id: str, progress: Progress) -> None:
        document = json.dumps({"stage": progress.stage, "fraction": progress.fraction})
        self.connection.set(_progress_key(job_id), document, ex=_PROGRESS_TTL_S)

    def activities(self, job_ids: Iterable[str]) -> dict[str, Activity]:
        """What the queue knows about some unfinished jobs."""
        asked = list(job_ids)
        with self.connection.pipeline(transaction=False) as pipeline:
            for job_id in asked:
                pipeline.mget(_lease_key(job_id), _progress_key(job_id))
                for key in self._waiting_keys:
                    pipeline.lpos(key, job_id)
            answers = pipeline.execute()
        each = 1 + len(self._waiting_keys)
        indices = zip(*(answers[1 + number :: each] for number in range(each - 1)), strict=True)
        return {
            job_id: _activity(lease, document, found)
            for job_id, (lease, document), found in zip(asked, answers[::each], indices, strict=True)
        }

    def activity(self, job_id: str) -> Activity:
        return self.activities([job_id])[job_id]

    def worker_counts(self) -> dict[SizeClass, int]:
        """The workers for each queue that gave a sign of life within the last half a minute."""
        with self.connection.pipeline(transaction=False) as pipeline:
            for name in QUEUE_NAMES.values():
                pipeline.smembers(WORKERS_BY_QUEUE_KEY % name)
            registered = pipeline.execute()
        return {
            size: self.connection.exists(*workers) if workers else 0
            for size, workers in zip(SizeClass, registered, strict=True)
        }

    def lengths(self) -> dict[SizeClass, int]:
        """The jobs that wait in each queue."""
        return {size: int(self.connection.llen(entries.key)) for size, entries in self.entries.items()}

    def ages_s(self, at: datetime) -> dict[SizeClass, float]:
        """For how long the next job of each queue has been waiting, in seconds; 0 where none waits."""
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
        """The jobs that have a lease. It walks over every key of Redis: for now and then."""
        prefix = _lease_key("")
        return [key.decode().removeprefix(prefix) for key in self.connection.scan_iter(f"{prefix}*", count=1000)]

    def claim(self, what: str, name: str, lease_s: float) -> bool:
        """Whether this process may do something that one of an installation may do at a time."""
        return bool(self.connection.set(f"cleave:claim:{what}", name, nx=True, px=_milliseconds(lease_s)))

    def give_back(self, what: str) -> None:
        self.connection.delete(f"cleave:claim:{what}")

    def lead(self, name: str, lease_s: float) -> bool:
        """Whether this process may do what only one of an installation may do at a time; to be asked every time."""
        with self.connection.pipeline() as transaction:
            transaction.set(_LEADER_KEY, name, nx=True, px=_milliseconds(lease_s))
            transaction.get(_LEADER_KEY)
            leads = bool(transaction.execute()[1] == name.encode())
        if leads:
            self.connection.pexpire(_LEADER_KEY, _milliseconds(lease_s))
        return leads

    def forget_dead_workers(self) -> None:
        for entries in self.entries.values():
            clean_worker_registry(entries)


def text_of(answer: bytes | str) -> str:
    return answer.decode() if isinstance(answer, bytes) else answer


def _lease_key(job_id: str) -> str:
    return f"cleave:lease:{job_id}"


def _progress_key(job_id: str) -> str:
    return f"cleave:progress:{job_id}"


def _milliseconds(seconds: float) -> int:
    return max(1, round(1000 * seconds))


def _activity(lease: bytes | None, document: bytes | None, indices: tuple[int | None, ...]) -> Activity:
    progress = _progress(document) if lease and document else None
    position = None if lease else next((index + 1 for index in indices if index is not None), None)
    return Activity(running=lease is not None, progress=progress, position=position)


def _progress(document: bytes) -> Progress:
    values: dict[str, Any] = json.loads(document)
    return Progress(stage=str(values["stage"]), fraction=float(values["fraction"]))
