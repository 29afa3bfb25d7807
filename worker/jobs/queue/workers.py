"""The registered workers; one is alive as long as its last heartbeat has not expired in Redis."""

import socket

from redis import Redis
from rq.worker_registration import WORKERS_BY_QUEUE_KEY, clean_worker_registry

from worker.jobs.queue.connection import text_of
from worker.jobs.queue.queue import QUEUE_NAMES, JobQueue
from worker.jobs.size_class import SizeClass

HEARTBEAT_TTL_S = 30  # a worker sends one every second while it runs a job, and every 5 s while it waits for one
_WORKER_KEY = "rq:worker:"  # rq's prefix


def live_workers(connection: Redis) -> list[str]:
    """Return the names of the workers that are alive; each begins with the name of its host.

    Raises
    ------
    QueueError
        If Redis does not answer.
    """
    registered = [connection.smembers(WORKERS_BY_QUEUE_KEY % name) for name in QUEUE_NAMES.values()]
    keys = sorted({text_of(key) for one in registered for key in one})
    alive = (key for key in keys if connection.exists(key))
    return [key.removeprefix(_WORKER_KEY) for key in alive]


def live_workers_here(connection: Redis) -> list[str]:
    """Return the names of those of this host or container."""
    return [name for name in live_workers(connection) if name.startswith(f"{socket.gethostname()}.")]


def worker_counts(connection: Redis) -> dict[SizeClass, int]:
    """Return the number of workers of each queue that are alive."""
    with connection.pipeline(transaction=False) as pipeline:
        for name in QUEUE_NAMES.values():
            pipeline.smembers(WORKERS_BY_QUEUE_KEY % name)
        registered = pipeline.execute()
    return {
        size: connection.exists(*workers) if workers else 0 for size, workers in zip(SizeClass, registered, strict=True)
    }


def forget_dead_workers(queue: JobQueue) -> None:
    """Remove the registrations of workers that are not alive."""
    for entries in queue.entries.values():
        clean_worker_registry(entries)
