"""Measures the sweeps of the janitor over many stored or waiting jobs."""

from __future__ import annotations

import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_context
from pathlib import Path
from typing import TypeVar

from bench.stored.cost import Cost, cost_of
from cleave.settings import Settings
from service.host.queue_server import embedded_queue_server
from worker.janitor.census import Census
from worker.janitor.janitor import Janitor
from worker.janitor.retention import Retention
from worker.jobs.queue.connection import connect
from worker.jobs.queue.queue import JobQueue
from worker.jobs.size_class import SizeClass
from worker.jobs.store.opening import open_folder

Measured = TypeVar("Measured")

_SWEEPS = 200
_QUEUE_TIMEOUT_S = 30.0  # longer than a busy machine delays a response; set by hand
_EXPIRED_S = 1.25 * 365 * 24 * 3600.0  # between the ages of the jobs of bench.stored.filling


def janitor_costs(data_dir: Path, rounds: int) -> list[tuple[str, Cost]]:
    """Return the costs for a folder of stored jobs; ``rounds`` of retention remove 50 expired jobs each."""
    return _in_process(_janitor_costs, data_dir, rounds)


def waiting_cost(data_dir: Path) -> Cost:
    """Return the cost of a sweep over waiting jobs, on average of those that list them and those that do not."""
    return _in_process(_waiting_cost, data_dir)


def _in_process(measure: Callable[..., Measured], *arguments: object) -> Measured:
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as process:
        return process.submit(measure, *arguments).result()


def _janitor_costs(data_dir: Path, rounds: int) -> list[tuple[str, Cost]]:
    store = open_folder(data_dir)
    retention = Retention(store, Settings(data_dir=data_dir, retention_s=_EXPIRED_S), Census(store.ended, 1))
    with _janitor(data_dir) as janitor:
        return [
            ("opening the store", cost_of(lambda _: open_folder(data_dir), _SWEEPS)),
            ("sweep of the janitor", cost_of(janitor.sweep, _SWEEPS)),
            ("retention, 50 jobs", cost_of(lambda _: retention.step(time.time()), rounds)),
        ]


def _waiting_cost(data_dir: Path) -> Cost:
    with _janitor(data_dir) as janitor:
        return cost_of(janitor.sweep, _SWEEPS)


@contextmanager
def _janitor(data_dir: Path) -> Iterator[Janitor]:
    """Provide a janitor with a queue server of its own, in which all unfinished jobs wait."""
    store = open_folder(data_dir)
    with tempfile.TemporaryDirectory(prefix="cleave-queue-") as folder:
        server = embedded_queue_server(Path(folder))
        with subprocess.Popen(server.command) as process:
            try:
                while not server.is_answering():
                    time.sleep(0.05)
                queue = JobQueue(connect(server.url, timeout_s=_QUEUE_TIMEOUT_S))
                for marker in store.pending.markers():
                    queue.enqueue(marker.job_id, SizeClass.SMALL)
                yield Janitor(store, queue, Settings(data_dir=data_dir))
            finally:
                process.terminate()
