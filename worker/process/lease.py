"""Renewal of the lease of a running job."""

import logging
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Event, Thread

from redis.client import Pipeline

from worker.jobs.queue.connection import QueueError
from worker.jobs.queue.queue import JobQueue

log = logging.getLogger("cleave.worker")

_RENEW_S = 1.0  # a third of the shortest lease that the settings allow


class LeaseKeeper:
    """Renews leases and sends heartbeats of the worker; errors of Redis are logged and ignored."""

    def __init__(self, queue: JobQueue, worker: str, lease_s: float, heartbeat: Callable[[Pipeline], None]) -> None:
        """``queue`` needs a connection with a short timeout."""
        self._queue = queue
        self._worker = worker
        self._lease_s = lease_s
        self._heartbeat = heartbeat

    def renew(self, job_id: str) -> None:
        try:
            self._queue.renew(job_id, self._worker, self._lease_s)
            with self._queue.connection.pipeline() as pipeline:
                self._heartbeat(pipeline)
                pipeline.execute()
        except QueueError as error:
            log.warning("the lease of job %s was not renewed: %s", job_id, error)

    @contextmanager
    def kept(self, job_id: str) -> Iterator[None]:
        """Renew a lease from a thread until the context exits."""
        has_ended = Event()

        def renew() -> None:
            while not has_ended.wait(_RENEW_S):
                self.renew(job_id)

        thread = Thread(target=renew, daemon=True)
        thread.start()
        try:
            yield
        finally:
            has_ended.set()
            thread.join()
