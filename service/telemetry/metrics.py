"""Metrics for Prometheus: what this process has answered, how the queue is, and what all workers have done."""

from prometheus_client import CollectorRegistry, Counter, Histogram

from service.telemetry.collectors import QueueCollector, StoreCollector, TallyCollector
from worker.jobs.queue.queue import JobQueue
from worker.jobs.store.store import JobStore

_BUCKETS_S = (0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 2.5, 5.0, 10.0, 30.0, 60.0)


class Metrics:
    """The metrics of one application."""

    def __init__(self, store: JobStore, queue: JobQueue) -> None:
        self.registry = CollectorRegistry()
        self.requests = Counter(
            "cleave_requests", "Requests that were answered.", ["method", "route", "status"], registry=self.registry
        )
        self.seconds = Histogram(
            "cleave_request_seconds",
            "Time from a request to the end of its answer.",
            ["route"],
            buckets=_BUCKETS_S,
            registry=self.registry,
        )
        self.jobs = Counter(
            "cleave_jobs_submitted", "Jobs by what became of the request.", ["result"], registry=self.registry
        )
        self.upload_bytes = Counter("cleave_upload_bytes", "Bytes of meshes taken in.", registry=self.registry)
        self._store_errors = 0
        self.registry.register(StoreCollector(store, self.store_failed))
        self.registry.register(QueueCollector(queue))
        self.registry.register(TallyCollector(queue.connection, lambda: self._store_errors))

    def store_failed(self) -> None:
        """This process could not read or write the store."""
        self._store_errors += 1
