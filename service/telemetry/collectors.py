"""Collectors of the metrics that all services of an installation share: of the store, the queue and the workers.

They are read at every scrape, and every service returns the same values: aggregate them over services with ``max``, not
with ``sum``. The counters restart at 0 if Redis loses its data.
"""

import shutil
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, HistogramMetricFamily, Metric
from prometheus_client.registry import Collector
from redis import Redis

from worker.jobs.job import now
from worker.jobs.queue.connection import QueueError
from worker.jobs.queue.counters import BOUNDS_S, Durations, JobCounters, durations
from worker.jobs.queue.queue import JobQueue
from worker.jobs.queue.workers import worker_counts
from worker.jobs.size_class import SizeClass
from worker.jobs.store.store import JobStore

_STARTING = "starting"  # the stage of a job that has not reported one yet

Counts = Mapping[tuple[str, ...], float]


class StoreCollector(Collector):
    """Metrics of the store: how many jobs are unfinished, and the age of the oldest one."""

    def __init__(self, store: JobStore, on_error: Callable[[], None]) -> None:
        self._store = store
        self._on_error = on_error

    def collect(self) -> Iterator[Metric]:
        try:
            count, oldest_s = self._store.pending.count(None)[0], self._store.pending.oldest_s(time.time())
        except OSError:
            self._on_error()
            yield _gauge("cleave_store_up", "Whether the store answers.", 0)
            return
        yield _gauge("cleave_store_up", "Whether the store answers.", 1)
        yield _gauge("cleave_unfinished_jobs", "Jobs without an outcome.", count)
        yield _gauge("cleave_oldest_unfinished_seconds", "Age of the oldest of them.", oldest_s)


class QueueCollector(Collector):
    """Metrics of the queue: jobs that wait, jobs that run, and workers that are alive."""

    def __init__(self, queue: JobQueue) -> None:
        self._queue = queue

    def collect(self) -> Iterator[Metric]:
        try:
            waiting, ages = self._queue.lengths(), self._queue.ages_s(now())
            workers = worker_counts(self._queue.connection)
            running = self._queue.activities(self._queue.running())
        except QueueError:
            yield _gauge("cleave_queue_up", "Whether the queue server answers.", 0)
            return
        stages = Counter(one.progress.stage if one.progress else _STARTING for one in running.values())
        yield _gauge("cleave_queue_up", "Whether the queue server answers.", 1)
        yield _by_queue("cleave_waiting_jobs", "Jobs in a queue.", waiting)
        yield _by_queue("cleave_queue_age_seconds", "How long the next job of a queue has been waiting.", ages)
        yield _by_queue("cleave_workers", "Living workers of a queue.", workers)
        yield _family(GaugeMetricFamily, "cleave_running_jobs", "Running jobs by their stage.", "stage", stages)


class DiskCollector(Collector):
    """Metrics of the disk of the data folder of this machine."""

    def __init__(self, data_dir: Path) -> None:
        self._data_dir = data_dir

    def collect(self) -> Iterator[Metric]:
        try:
            disk = shutil.disk_usage(self._data_dir)
        except OSError:
            return
        yield _gauge("cleave_disk_free_bytes", "Free bytes on the disk of the data folder.", disk.free)
        yield _gauge("cleave_disk_bytes", "Size of that disk.", disk.total)


class CounterCollector(Collector):
    """Metrics that the workers and the janitor count in Redis, and the errors of the store in this process."""

    def __init__(self, connection: Redis, own_store_errors: Callable[[], int]) -> None:
        self._counters = JobCounters(connection)
        self._own_store_errors = own_store_errors

    def collect(self) -> Iterator[Metric]:
        own = {"service": float(self._own_store_errors())}
        try:
            counts, stored = self._counters.counts(), self._counters.stored()
        except QueueError:  # a counter of 0 would look like an increase when Redis is back
            yield _store_errors(own)
            return
        yield _store_errors(own | _labelled(counts, "store_errors"))
        yield _finished(counts)
        yield _family(
            CounterMetricFamily,
            "cleave_lost_attempts",
            "Attempts that ended without an outcome; a job has at most CLEAVE_MAX_ATTEMPTS.",
            "cause",
            _labelled(counts, "lost"),
        )
        if stored is not None:
            size = "Size of the meshes and results of all ended jobs, when the janitor last counted them."
            yield _gauge("cleave_stored_bytes", size, stored.size_bytes)
            yield _gauge("cleave_stored_jobs", "Ended jobs, when the janitor last counted them.", stored.jobs)
        yield CounterMetricFamily("cleave_faces", "Faces that were segmented.", counts.get(("faces",), 0.0))
        yield CounterMetricFamily(
            "cleave_recovered_jobs",
            "Jobs that the queue lost and the janitor enqueued again.",
            counts.get(("recovered",), 0.0),
        )
        yield _histogram(
            "cleave_job_seconds", "Time from a job's acceptance to its end.", [], {(): durations(counts, ("job",))}
        )
        stages: dict[tuple[str, ...], Durations] = {
            (name[1],): durations(counts, name[:2]) for name in counts if name[0] == "stage"
        }
        yield _histogram("cleave_stage_seconds", "Duration of a stage of a job.", ["stage"], stages)


def _store_errors(values: Mapping[str, float]) -> Metric:
    text = "Reads and writes of the store that failed."
    return _family(CounterMetricFamily, "cleave_store_errors", text, "process", values)


def _finished(counts: Counts) -> Metric:
    metric = CounterMetricFamily("cleave_jobs_finished", "Jobs by their outcome.", labels=["status", "code"])
    for name, value in counts.items():
        if name[0] == "finished":
            metric.add_metric(name[1:], value)
    return metric


def _labelled(counts: Counts, kind: str) -> dict[str, float]:
    return {name[1]: value for name, value in counts.items() if name[0] == kind}


def _histogram(name: str, text: str, labels: list[str], values: Mapping[tuple[str, ...], Durations]) -> Metric:
    metric = HistogramMetricFamily(name, text, labels=labels)
    for given, one in values.items():
        total, buckets = 0.0, []
        for bound, count in zip((*BOUNDS_S, "+Inf"), one.counts, strict=True):
            total += count
            buckets.append((str(bound), total))
        metric.add_metric(given, buckets, one.sum_s)
    return metric


def _by_queue(name: str, text: str, values: Mapping[SizeClass, float]) -> Metric:
    return _family(GaugeMetricFamily, name, text, "queue", {str(size): value for size, value in values.items()})


def _family(
    kind: type[GaugeMetricFamily] | type[CounterMetricFamily],
    name: str,
    text: str,
    label: str,
    values: Mapping[str, float],
) -> Metric:
    metric = kind(name, text, labels=[label])
    for given, value in values.items():
        metric.add_metric([given], value)
    return metric


def _gauge(name: str, text: str, value: float) -> Metric:
    return GaugeMetricFamily(name, text, value=value)
