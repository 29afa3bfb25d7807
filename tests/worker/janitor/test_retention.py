"""Retention: old jobs and jobs above the size limit are removed, except those that a client still waits for."""

import time
from dataclasses import replace

import pytest
from redis import Redis

from cleave.settings import Settings
from helpers.jobs import accepted
from worker.janitor.retention import Housekeeping, StoredJob, remove_surplus, stored_jobs, surplus
from worker.jobs.job import Job, Succeeded, new_job_id, now
from worker.jobs.queue.counters import JobCounters, Stored
from worker.jobs.store.store import JobStore

DAY_S = 24 * 3600.0
NOW_S = 1000 * DAY_S


def job(age_days: float | None, size_bytes: int = 1) -> StoredJob:
    return StoredJob(new_job_id(), size_bytes, None if age_days is None else NOW_S - age_days * DAY_S, is_accepted=True)


def ids(*jobs: StoredJob) -> list[str]:
    return [one.id for one in jobs]


def test_jobs_above_the_age_limit_are_removed_oldest_first() -> None:
    young, old, older = job(1), job(3), job(5)
    settings = Settings(retention_s=2 * DAY_S)
    assert surplus([young, old, older], set(), settings, NOW_S) == ids(older, old)


def test_the_first_jobs_to_end_are_removed_until_the_rest_is_below_the_size_limit() -> None:
    jobs = [job(age, 100) for age in (4, 3, 2, 1)]
    assert surplus(jobs, set(), Settings(retention_bytes=400), NOW_S) == []
    assert surplus(jobs, set(), Settings(retention_bytes=399), NOW_S) == ids(jobs[0])
    assert surplus(jobs, set(), Settings(retention_bytes=250), NOW_S) == ids(*jobs[:2])
    assert surplus(jobs, set(), Settings(retention_bytes=0), NOW_S) == ids(*jobs)


def test_jobs_whose_end_was_not_reported_yet_are_kept() -> None:
    settings = Settings(retention_s=0, retention_bytes=0, max_wait_s=60)
    unfinished, just_ended, undelivered = job(None, 10**9), job(100 / DAY_S), job(9)
    arriving = replace(job(None), is_accepted=False)
    assert surplus([unfinished, just_ended, undelivered, arriving], {undelivered.id}, settings, NOW_S) == []


def test_unfinished_jobs_count_towards_the_size_but_are_kept() -> None:
    unfinished, ended = job(None, 10**9), job(2)
    assert surplus([unfinished, ended], set(), Settings(retention_bytes=100), NOW_S) == ids(ended)


def ended_job(store: JobStore) -> Job:
    one = accepted(store, b"mesh bytes")
    store.results.write(one.id, lambda target: target.write(b"result"))
    store.finish(one.id, Succeeded(finished_at=now(), faces=4, vertices=4, max_segments=3, automatic_segments=2))
    return one


def test_a_sweep_deletes_ended_jobs_and_keeps_unfinished_ones(any_store: JobStore) -> None:
    ended, waiting = ended_job(any_store), accepted(any_store, b"mesh")
    for settings in (Settings(), Settings(retention_s=2 * DAY_S)):
        remove_surplus(any_store, stored_jobs(any_store), settings, time.time() + DAY_S)
        assert any_store.records.job(ended.id) == ended
    remove_surplus(any_store, stored_jobs(any_store), Settings(retention_s=DAY_S / 2), time.time() + DAY_S)
    assert any_store.records.job(ended.id) is None
    assert any_store.deletions.was_deleted(ended.id, None)
    assert any_store.records.job(waiting.id) == waiting
    assert [one.id for one in stored_jobs(any_store)] == [waiting.id]


def test_a_sweep_counts_every_byte_of_a_job(any_store: JobStore) -> None:
    ended = ended_job(any_store)
    (stored,) = stored_jobs(any_store)
    assert stored.size_bytes > len(b"mesh bytes") + len(b"result")
    remove_surplus(any_store, stored_jobs(any_store), Settings(retention_bytes=stored.size_bytes), time.time() + DAY_S)
    assert any_store.records.job(ended.id) == ended
    remove_surplus(
        any_store, stored_jobs(any_store), Settings(retention_bytes=stored.size_bytes - 1), time.time() + DAY_S
    )
    assert any_store.records.job(ended.id) is None


@pytest.mark.parametrize(("settings", "lists"), [({"retention_s": 1.0}, 3), ({}, 2)])
def test_the_jobs_are_listed_rarely(
    store: JobStore, connection: Redis, monkeypatch: pytest.MonkeyPatch, settings: dict[str, float], lists: int
) -> None:
    """Twice a minute if they may be removed, and once an hour for the metrics."""
    sweeps: list[float] = []
    monkeypatch.setattr("worker.janitor.retention.remove_surplus", lambda *_: sweeps.append(0))
    counters = JobCounters(connection)
    assert counters.stored() is None
    housekeeping = Housekeeping(store, Settings(**settings), counters)
    for at_s in (0.0, 1.0, 29.0, 31.0, 32.0, 3601.0):
        housekeeping.sweep(at_s)
    assert len(sweeps) == lists
    assert counters.stored() == Stored(0, 0)


def test_the_size_of_all_jobs_is_noted_for_the_metrics(store: JobStore, connection: Redis) -> None:
    job = accepted(store, b"mesh")
    counters = JobCounters(connection)
    Housekeeping(store, Settings(), counters).sweep(0.0)
    (listed,) = stored_jobs(store)
    assert counters.stored() == Stored(1, listed.size_bytes)
    assert listed.id == job.id
    assert listed.size_bytes > len(b"mesh")
