"""The janitor: jobs that the queue has lost are enqueued again, and jobs without attempts left fail."""

import os
from pathlib import Path

import pytest
from redis import Redis
from rq import Queue
from rq.serializers import JSONSerializer

from cleave.settings import Settings
from helpers.jobs import LARGE, SMALL, accepted
from worker.janitor.janitor import MISSING_S, Janitor
from worker.jobs.job import Failed, new_job_id
from worker.jobs.queue.connection import QueueError
from worker.jobs.queue.entries import FUNCTION_NAME
from worker.jobs.queue.locks import Locks
from worker.jobs.queue.queue import JobQueue
from worker.jobs.store.store import JobStore


@pytest.fixture
def janitor(store: JobStore, queue: JobQueue, tmp_path: Path) -> Janitor:
    return Janitor(store, queue, Settings(data_dir=tmp_path, max_attempts=3))


def waiting(queue: JobQueue) -> list[str]:
    ids: list[str] = queue.entries[SMALL].get_job_ids()
    return ids


def test_an_accepted_job_that_was_never_enqueued_is_enqueued_after_some_seconds(
    janitor: Janitor, store: JobStore, queue: JobQueue
) -> None:
    job = accepted(store, b"mesh")
    janitor.sweep(0.0)
    assert waiting(queue) == []
    janitor.sweep(MISSING_S)
    assert waiting(queue) == [job.id]


def test_a_wiped_queue_is_filled_again(janitor: Janitor, store: JobStore, queue: JobQueue, connection: Redis) -> None:
    jobs = [accepted(store, b"mesh") for _ in range(5)]
    for job in jobs:
        queue.enqueue(job.id, SMALL)
    connection.flushall()
    janitor.sweep(0.0)
    janitor.sweep(MISSING_S)
    assert sorted(waiting(queue)) == sorted(job.id for job in jobs)


def test_lost_jobs_are_enqueued_before_waiting_ones_in_the_order_of_their_acceptance(
    janitor: Janitor, store: JobStore, queue: JobQueue
) -> None:
    lost = [accepted(store, b"mesh") for _ in range(3)]
    waits = accepted(store, b"mesh")
    queue.enqueue(waits.id, SMALL)
    janitor.sweep(0.0)
    janitor.sweep(MISSING_S)
    assert waiting(queue) == [job.id for job in (*lost, waits)]


def test_lost_jobs_are_enqueued_in_the_queue_of_their_size(store: JobStore, queue: JobQueue, tmp_path: Path) -> None:
    janitor = Janitor(store, queue, Settings(data_dir=tmp_path, large_job_bytes=5))
    small, large = accepted(store, b"1234"), accepted(store, b"12345")
    janitor.sweep(0.0)
    janitor.sweep(MISSING_S)
    assert {size: entries.get_job_ids() for size, entries in queue.entries.items()} == {
        SMALL: [small.id],
        LARGE: [large.id],
    }


def test_jobs_in_the_single_queue_of_an_earlier_version_are_moved(
    janitor: Janitor, store: JobStore, queue: JobQueue, connection: Redis
) -> None:
    job = accepted(store, b"mesh")
    Queue("cleave", connection=connection, serializer=JSONSerializer).enqueue(FUNCTION_NAME, job.id, job_id=job.id)
    janitor.sweep(0.0)
    janitor.sweep(MISSING_S)
    assert waiting(queue) == [job.id]
    assert queue.activity(job.id).position == 1


def test_jobs_that_wait_or_run_are_not_enqueued_again(janitor: Janitor, store: JobStore, queue: JobQueue) -> None:
    waits, runs = accepted(store, b"mesh"), accepted(store, b"mesh")
    queue.enqueue(waits.id, SMALL)
    queue.take(runs.id, "worker", lease_s=30)
    janitor.sweep(0.0)
    janitor.sweep(MISSING_S)
    assert waiting(queue) == [waits.id]


def test_a_job_that_is_found_between_two_sweeps_is_not_lost(janitor: Janitor, store: JobStore, queue: JobQueue) -> None:
    job = accepted(store, b"mesh")
    janitor.sweep(0.0)
    queue.take(job.id, "worker", lease_s=30)
    janitor.sweep(MISSING_S / 2)
    queue.release(job.id, "worker")
    janitor.sweep(MISSING_S)
    assert waiting(queue) == []


def test_a_sweep_that_fails_restarts_the_time_for_which_a_job_must_be_missing(
    janitor: Janitor, store: JobStore, queue: JobQueue
) -> None:
    accepted(store, b"mesh")
    janitor.sweep(0.0)
    janitor.sweep_failed(QueueError())
    janitor.sweep(MISSING_S)
    assert waiting(queue) == []


def test_finished_and_deleted_jobs_are_not_enqueued(janitor: Janitor, store: JobStore, queue: JobQueue) -> None:
    finished, deleted = accepted(store, b"mesh"), accepted(store, b"mesh")
    store.finish(finished.id, Failed(finished_at=finished.created_at, code="c", message="m"))
    store.delete(deleted.id)
    janitor.sweep(0.0)
    janitor.sweep(MISSING_S)
    assert waiting(queue) == []


def test_a_job_without_attempts_left_fails_with_the_cause_of_the_last_one(
    janitor: Janitor, store: JobStore, queue: JobQueue
) -> None:
    job = accepted(store, b"mesh")
    for cause in ("worker_lost", "worker_lost", "out_of_memory"):
        store.records.end_attempt(job.id, store.begin_attempt(job.id, "worker"), cause)
    janitor.sweep(0.0)
    janitor.sweep(MISSING_S)
    outcome = store.records.outcome(job.id)
    assert isinstance(outcome, Failed)
    assert outcome.code == "out_of_memory"
    assert waiting(queue) == []


def test_attempts_whose_worker_died_count_as_well(janitor: Janitor, store: JobStore) -> None:
    job = accepted(store, b"mesh")
    for _ in range(3):
        store.begin_attempt(job.id, "worker")
    janitor.sweep(0.0)
    janitor.sweep(MISSING_S)
    outcome = store.records.outcome(job.id)
    assert isinstance(outcome, Failed)
    assert outcome.code == "worker_lost"
    assert "3 times" in outcome.message


def test_one_of_several_janitors_is_active(janitor: Janitor, store: JobStore, queue: JobQueue) -> None:
    assert Locks(queue.connection).lead("another", ttl_s=60)
    accepted(store, b"mesh")
    janitor.sweep(0.0)
    janitor.sweep(MISSING_S)
    assert waiting(queue) == []


def test_a_restarted_janitor_leads_at_once(
    janitor: Janitor, store: JobStore, queue: JobQueue, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    job = accepted(store, b"mesh")
    janitor.sweep(0.0)
    monkeypatch.setattr(os, "getpid", lambda: 1)
    successor = Janitor(store, queue, Settings(data_dir=tmp_path))
    successor.sweep(1.0)
    successor.sweep(1.0 + MISSING_S)
    assert waiting(queue) == [job.id]


def test_an_entry_without_a_job_is_ignored(janitor: Janitor, queue: JobQueue) -> None:
    queue.enqueue(new_job_id(), SMALL)
    janitor.sweep(0.0)
    janitor.sweep(MISSING_S)
    assert len(waiting(queue)) == 1
