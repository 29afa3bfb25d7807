"""Admission: an owner's jobs are enqueued in order up to the limit, and do not delay jobs of others."""

from collections.abc import Callable
from dataclasses import replace

import pytest

from cleave.settings import Settings
from helpers.jobs import SMALL, accepted
from worker.janitor.janitor import MISSING_S, Janitor
from worker.jobs.admission import admit, belonging_in_queue
from worker.jobs.job import Canceled, Job, new_job_id, now
from worker.jobs.queue.queue import JobQueue
from worker.jobs.store.pending import Marker
from worker.jobs.store.store import JobStore


@pytest.fixture
def submitted(store: JobStore) -> Callable[[str], Job]:
    def submit(owner: str) -> Job:
        template = accepted(store, b"mesh")
        store.delete(template.id)
        with store.spool.begin_upload() as upload:
            job = replace(template, id=new_job_id(), owner=owner, created_at=now())
            store.accept(job, upload)
        return job

    return submit


def waiting(queue: JobQueue) -> list[str]:
    ids: list[str] = queue.entries[SMALL].get_job_ids()
    return ids


def test_an_owner_has_no_more_jobs_in_the_queue_than_allowed(
    store: JobStore, queue: JobQueue, submitted: Callable[[str], Job]
) -> None:
    two_each = Settings(key_max_running_jobs=2)
    mine = [submitted("me") for _ in range(4)]
    for job in mine:
        admit(store, queue, two_each, "me", job)
    theirs = submitted("them")
    admit(store, queue, two_each, "them", theirs)
    assert waiting(queue) == [mine[0].id, mine[1].id, theirs.id]
    store.finish(mine[0].id, Canceled(finished_at=now()))
    queue.forget(mine[0].id)
    admit(store, queue, two_each, "me")
    assert waiting(queue) == [mine[1].id, theirs.id, mine[2].id]


def test_without_a_limit_every_job_is_enqueued(
    store: JobStore, queue: JobQueue, submitted: Callable[[str], Job]
) -> None:
    jobs = [submitted("me") for _ in range(3)]
    for job in jobs:
        admit(store, queue, Settings(), "me", job)
    assert waiting(queue) == [job.id for job in jobs]


def test_running_jobs_count_towards_the_limit(
    store: JobStore, queue: JobQueue, submitted: Callable[[str], Job]
) -> None:
    first, second = submitted("me"), submitted("me")
    queue.take(first.id, "worker", lease_s=30)
    admit(store, queue, Settings(key_max_running_jobs=1), "me", second)
    assert waiting(queue) == []


def test_the_janitor_enqueues_lost_jobs_up_to_the_limit(
    store: JobStore, queue: JobQueue, submitted: Callable[[str], Job], settings: Settings
) -> None:
    jobs = [submitted("me") for _ in range(3)]
    janitor = Janitor(store, queue, settings)
    janitor.sweep(0.0)
    janitor.sweep(MISSING_S)
    assert waiting(queue) == [jobs[0].id]


@pytest.fixture
def settings(store: JobStore) -> Settings:
    del store
    return Settings(key_max_running_jobs=1)


def test_the_oldest_jobs_of_each_owner_belong_in_the_queue() -> None:
    times = (f"20260101T000000{number:06}" for number in range(10))
    markers = [
        Marker(f"pending/{time}-{new_job_id()}{owner}")
        for time, owner in zip(times, (".a", ".b", ".a", ".a", "", ""), strict=False)
    ]
    assert belonging_in_queue(markers, 1) == [markers[0], markers[1], markers[4]]
    assert belonging_in_queue(markers, 2) == [*markers[:3], *markers[4:]]
    assert belonging_in_queue(markers, None) == markers
