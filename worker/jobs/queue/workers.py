"""Which workers are alive: those that gave a sign of life within the last half a minute."""

import socket

from redis import Redis
from rq.worker_registration import WORKERS_BY_QUEUE_KEY

from worker.jobs.queue.queue import QUEUE_NAMES, text_of

_WORKER_KEY = "rq:worker:"


def living_workers(connection: Redis) -> list[str]:
    """Their names, which begin with those of their machines.

    Raises
    ------
    QueueError
        Where Redis does not answer.
    """
    registered = [connection.smembers(WORKERS_BY_QUEUE_KEY % name) for name in QUEUE_NAMES.values()]
    keys = sorted({text_of(key) for one in registered for key in one})
    alive = (key for key in keys if connection.exists(key))
    return [key.removeprefix(_WORKER_KEY) for key in alive]


def living_workers_here(connection: Redis) -> list[str]:
    """Those of this machine, or of this container."""
    return [name for name in living_workers(connection) if name.startswith(f"{socket.gethostname()}.")]
