"""Metrics for Prometheus: what this process has answered, and how the queue is."""

import time
from collections.abc import Iterator

from prometheus_client import CollectorRegistry, Counter, Histogram
from prometheus_client.core import GaugeMetricFamily, Metric
from prometheus_client.registry import Collector

from worker.queue import JobQueue, QueueError
from worker.size_class import SizeClass
from worker.store import JobStore

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
        self.registry.register(_QueueCollector(store, queue))


class _QueueCollector(Collector):
    def __init__(self, store: JobStore, queue: JobQueue) -> None:
        self._store = store
        self._queue = queue

    def collect(self) -> Iterator[Metric]:
        yield _gauge("cleave_unfinished_jobs", "Jobs without an outcome.", self._store.count_unfinished(None)[0])
        yield _gauge(
            "cleave_oldest_unfinished_seconds",
            "Age of the oldest of them.",
            self._store.oldest_s(time.time()),
        )
        try:
            waiting, workers = self._queue.lengths(), self._queue.worker_counts()
        except QueueError:
            yield _gauge("cleave_queue_up", "Whether the queue server answers.", 0)
            return
        yield _gauge("cleave_queue_up", "Whether the queue server answers.", 1)
        yield _by_queue("cleave_waiting_jobs", "Jobs in a queue.", waiting)
        yield _by_queue("cleave_workers", "Workers of a queue that are alive.", workers)


def _by_queue(name: str, text: str, values: dict[SizeClass, int]) -> Metric:
    metric = GaugeMetricFamily(name, text, labels=["queue"])
    for size, value in values.items():
        metric.add_metric([size], value)
    return metric


def _gauge(name: str, text: str, value: float) -> Metric:
    return GaugeMetricFamily(name, text, value=value)
