"""Prometheus metrics of the requests of this process, and of the store, the queue and all workers."""

import platform
from pathlib import Path

from prometheus_client import (
    CollectorRegistry,
    Counter,
    Histogram,
    Info,
    ProcessCollector,
    disable_created_metrics,
)

from cleave.version import installed_version
from service.telemetry.collectors import CounterCollector, DiskCollector, QueueCollector, StoreCollector
from worker.jobs.queue.queue import JobQueue
from worker.jobs.store.store import JobStore

# The default buckets of Prometheus (of its Go client), and two more for requests that wait for up to CLEAVE_MAX_WAIT_S.
_BUCKETS_S = (0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 2.5, 5.0, 10.0, 30.0, 60.0)


class Metrics:
    """The metrics of one application."""

    def __init__(self, store: JobStore, queue: JobQueue, data_dir: Path) -> None:
        disable_created_metrics()  # type: ignore[no-untyped-call]  # they double the series, and Prometheus does not need them
        self.registry = CollectorRegistry()
        ProcessCollector(registry=self.registry)
        build = Info("cleave_build", "The version of the software.", registry=self.registry)
        build.info({"version": installed_version(), "python": platform.python_version()})
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
            "cleave_jobs_submitted", "Jobs by the result of the request.", ["result"], registry=self.registry
        )
        self.upload_bytes = Counter("cleave_upload_bytes", "Bytes of meshes received.", registry=self.registry)
        self._store_errors = 0
        self.registry.register(StoreCollector(store, self.store_failed))
        self.registry.register(QueueCollector(queue))
        self.registry.register(DiskCollector(data_dir))
        self.registry.register(CounterCollector(queue.connection, lambda: self._store_errors))

    def store_failed(self) -> None:
        """Count an error of the store in this process."""
        self._store_errors += 1
