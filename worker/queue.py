"""The queue: which job is next, which worker holds which job, how far it is; the store can make all of it again.

A waiting job is an entry in an rq queue. A running job has a lease, a key that its worker renews and that Redis drops
when the worker falls silent. Only job ids, stage names and numbers pass through Redis.
"""

import json
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
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
from rq.worker_registration import clean_worker_registry, get_keys

QUEUE_NAME = "cleave"
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
        self.entries = Queue(QUEUE_NAME, connection=connection, serializer=JSONSerializer)
        self._taken_key = IntermediateQueue.get_intermediate_queue_key(self.entries.key)

    def enqueue(self, job_id: str, *, at_front: bool = False) -> None:
        """Let a job wait for a worker; without effect where it waits already."""
        with suppress(DuplicateJobError):
            self.entries.enqueue(
                TASK, job_id, job_id=job_id, unique=True, at_front=at_front, job_timeout=_FOR_EVER, result_ttl=0
            )

    def requeue(self, job_id: str, *, at_front: bool = False) -> None:
        """Let a job wait for a worker whatever is left of an earlier entry."""
        self.forget(job_id)
        self.enqueue(job_id, at_front=at_front)

    def forget(self, job_id: str) -> None:
        """Remove the entry of a job and its progress."""
        with self.connection.pipeline() as transaction:
            transaction.lrem(self.entries.key, 0, job_id)
            transaction.lrem(self._taken_key, 0, job_id)
            transaction.delete(Entry.key_for(job_id), _progress_key(job_id))
            transaction.execute()

    def take(self, job_id: str, worker: str, lease_s: float) -> bool:
        """Begin to hold a job that was dequeued; False where another worker holds it."""
        with self.connection.pipeline() as transaction:
            transaction.set(_lease_key(job_id), worker, nx=True, px=_milliseconds(lease_s))
            transaction.lrem(self._taken_key, 0, job_id)
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
            transaction.lrange(self.entries.key, 0, -1)
            for job_id in asked:
                transaction.exists(_lease_key(job_id))
            waiting, *leased = transaction.execute()
        running = {job_id for job_id, lease in zip(asked, leased, strict=True) if lease}
        return running | ({entry.decode() for entry in waiting} & set(asked))

    def publish(self, job_id: str, progress: Progress) -> None:
        document = json.dumps({"stage": progress.stage, "fraction": progress.fraction})
        self.connection.set(_progress_key(job_id), document, ex=_PROGRESS_TTL_S)

    def activities(self, job_ids: Iterable[str]) -> dict[str, Activity]:
        """What the queue knows about some unfinished jobs."""
        asked = list(job_ids)
        with self.connection.pipeline(transaction=False) as pipeline:
            for job_id in asked:
                pipeline.mget(_lease_key(job_id), _progress_key(job_id))
                pipeline.lpos(self.entries.key, job_id)
            answers = pipeline.execute()
        return {
            job_id: _activity(lease, document, index)
            for job_id, (lease, document), index in zip(asked, answers[::2], answers[1::2], strict=True)
        }

    def activity(self, job_id: str) -> Activity:
        return self.activities([job_id])[job_id]

    def worker_count(self) -> int:
        """The workers that gave a sign of life within the last lease time or two."""
        keys = sorted(get_keys(self.entries))
        return self.connection.exists(*keys) if keys else 0

    def length(self) -> int:
        """The jobs that wait here."""
        return int(self.connection.llen(self.entries.key))

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
        clean_worker_registry(self.entries)


def _lease_key(job_id: str) -> str:
    return f"cleave:lease:{job_id}"


def _progress_key(job_id: str) -> str:
    return f"cleave:progress:{job_id}"


def _milliseconds(seconds: float) -> int:
    return max(1, round(1000 * seconds))


def _activity(lease: bytes | None, document: bytes | None, index: int | None) -> Activity:
    progress = _progress(document) if lease and document else None
    position = None if lease or index is None else index + 1
    return Activity(running=lease is not None, progress=progress, position=position)


def _progress(document: bytes) -> Progress:
    values: dict[str, Any] = json.loads(document)
    return Progress(stage=str(values["stage"]), fraction=float(values["fraction"]))
