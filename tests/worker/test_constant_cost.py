"""What a request or a sweep asks of the storage does not depend on the number of stored or waiting jobs."""

import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from redis import Redis

from bench.stored.filling import OWNERS, fill, fill_waiting
from cleave.settings import Settings
from helpers.jobs import SMALL
from helpers.storage.counting import counting
from worker.janitor.census import Census
from worker.janitor.janitor import Janitor
from worker.janitor.retention import Retention
from worker.jobs.job import Canceled, Job, new_job_id, now
from worker.jobs.queue.queue import JobQueue
from worker.jobs.store.layout import entry_name
from worker.jobs.store.opening import open_folder
from worker.jobs.store.store import JobStore

FEW, MANY = 600, 3000
FEW_WAITING, MANY_WAITING = 100, 1000
OLD_S = 1.25 * 365 * 24 * 3600.0


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> dict[int, tuple[Path, list[Job]]]:
    made = {}
    for jobs in (FEW, MANY):
        folder = tmp_path_factory.mktemp(f"{jobs}-jobs")
        made[jobs] = folder, fill(folder, jobs, expired=200).samples
    return made


def submit(store: JobStore, like: Job) -> Job:
    with store.spool.begin_upload() as upload:
        job = replace(like, id=new_job_id(), created_at=now())
        store.accept(job, upload)
    return job


def submit_and_finish(store: JobStore, samples: list[Job]) -> None:
    store.finish(submit(store, samples[-1]).id, Canceled(finished_at=now()))


def submit_known(store: JobStore, samples: list[Job]) -> None:
    assert store.finish_as_before(submit(store, samples[-1]))


def delete(store: JobStore, samples: list[Job]) -> None:
    store.delete(samples.pop().id)


OPERATIONS: dict[str, Callable[[JobStore, list[Job]], object]] = {
    "first page": lambda store, _: store.page(OWNERS[0], None, 10),
    "later page": lambda store, samples: store.page(OWNERS[0], entry_name(samples[len(samples) // 2]), 10),
    "job": lambda store, samples: (store.records.job(samples[0].id), store.records.states([samples[0].id])),
    "limits": lambda store, _: store.pending.count(OWNERS[0]),
    "submission and end": submit_and_finish,
    "submission with a stored result": submit_known,
    "deletion": delete,
    "forgetting": lambda store, _: store.deletions.forget(0.0),
    "retention": lambda store, _: Retention(store, Settings(retention_s=OLD_S), Census(store.ended, 1)).step(
        time.time()
    ),
    "opening": lambda store, _: open_folder(store.spool.folder.parent),
}


@pytest.mark.parametrize("name", OPERATIONS)
def test_the_cost_does_not_grow_with_the_number_of_stored_jobs(
    folders: dict[int, tuple[Path, list[Job]]], monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    costs = {}
    for jobs, (folder, samples) in folders.items():
        store = open_folder(folder)
        OPERATIONS[name](store, samples)  # creates folders that later calls find
        with monkeypatch.context() as patch:
            counted = counting(patch)
            OPERATIONS[name](store, samples)
            costs[jobs] = counted.total()
    assert costs[MANY] <= 1.5 * costs[FEW] + 40  # the days and minutes that one page touches


@pytest.fixture(scope="module")
def waiting(tmp_path_factory: pytest.TempPathFactory) -> dict[int, Path]:
    made = {jobs: tmp_path_factory.mktemp(f"{jobs}-waiting") for jobs in (FEW_WAITING, MANY_WAITING)}
    for jobs, folder in made.items():
        fill_waiting(folder, jobs)
    return made


def test_the_cost_of_a_sweep_does_not_grow_with_the_number_of_waiting_jobs(
    waiting: dict[int, Path], queue: JobQueue, connection: Redis, monkeypatch: pytest.MonkeyPatch
) -> None:
    """On average over a round: the more jobs wait, the more sweeps it has."""
    monkeypatch.setattr("worker.janitor.search._SEARCHED_AT_ONCE", FEW_WAITING)
    costs = {}
    for jobs, folder in waiting.items():
        connection.flushall()
        store = open_folder(folder)
        for marker in store.pending.markers():
            queue.enqueue(marker.job_id, SMALL)
        janitor, sweeps = Janitor(store, queue, Settings(data_dir=folder)), 2 * jobs // FEW_WAITING
        janitor.sweep(0.0)
        with monkeypatch.context() as patch:
            counted = counting(patch)
            for number in range(sweeps):
                janitor.sweep(1.0 + number / 100)
            costs[jobs] = counted.total() / sweeps
    assert costs[MANY_WAITING] <= 1.5 * costs[FEW_WAITING]
