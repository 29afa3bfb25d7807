"""Retention: old jobs and jobs above the size limit are removed, except those that a client still waits for."""

import time
from datetime import timedelta

import pytest
from redis import Redis

from cleave.settings import Settings
from helpers.jobs import accepted
from worker.janitor.census import Census
from worker.janitor.housekeeping import Housekeeping
from worker.janitor.retention import Retention
from worker.jobs.job import Job, Succeeded, now
from worker.jobs.queue.counters import JobCounters, Stored
from worker.jobs.store.outbox import Delivery
from worker.jobs.store.store import JobStore

DAY_S = 24 * 3600.0
SIZE = len(b"mesh bytes") + len(b"result")


def ended(store: JobStore, age_days: float) -> Job:
    """Return a job that ended so many days ago, with a mesh and a result."""
    job = accepted(store, b"mesh bytes")
    store.results.write(job.id, lambda target: target.write(b"result"))
    finished_at = now() - timedelta(days=age_days)
    store.finish(job.id, Succeeded(finished_at=finished_at, faces=4, vertices=4, max_segments=3, automatic_segments=2))
    return job


def removed(store: JobStore, jobs: list[Job], settings: Settings, at_s: float = 0.0) -> list[bool]:
    """Apply the settings to a store, ``at_s`` seconds from now; return which of the jobs have been removed."""
    census = Census(store.ended, 2)
    while not census.step():
        pass
    retention = Retention(store, settings, census)
    while retention.step(time.time() + at_s):
        pass
    return [store.records.job(job.id) is None for job in jobs]


@pytest.fixture
def few_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("worker.janitor.retention._REMOVED_AT_ONCE", 2)


def test_jobs_above_the_age_limit_are_removed(any_store: JobStore) -> None:
    jobs = [ended(any_store, age) for age in (1, 5, 3)]
    assert removed(any_store, jobs, Settings()) == [False, False, False]
    assert removed(any_store, jobs, Settings(retention_s=2 * DAY_S)) == [False, True, True]
    assert all(any_store.deletions.was_deleted(job.id, None) for job in jobs[1:])
    assert [one.id for one in any_store.ended.oldest("", 10)] == [jobs[0].id]


@pytest.mark.parametrize(
    ("limit", "count"), [(4 * SIZE, 0), (4 * SIZE - 1, 1), (3 * SIZE, 1), (3 * SIZE - 1, 2), (0, 4)]
)
def test_the_first_jobs_to_end_are_removed_until_the_rest_is_below_the_size_limit(
    store: JobStore, few_at_once: None, limit: int, count: int
) -> None:
    del few_at_once
    jobs = [ended(store, age) for age in (4, 3, 2, 1)]
    assert removed(store, jobs, Settings(retention_bytes=limit)) == [number < count for number in range(4)]


def test_jobs_whose_end_was_not_reported_yet_are_kept(store: JobStore) -> None:
    strict = Settings(retention_s=0, retention_bytes=0, max_wait_s=60)
    unfinished, just_ended = accepted(store, b"mesh"), ended(store, 100 / DAY_S)
    assert removed(store, [unfinished, just_ended], strict) == [False, False]
    assert removed(store, [unfinished, just_ended], strict, at_s=DAY_S) == [False, True]


def test_jobs_with_an_undelivered_webhook_are_kept_and_delay_no_others(store: JobStore, few_at_once: None) -> None:
    del few_at_once
    jobs = [ended(store, age) for age in range(9, 2, -1)]
    for job in jobs[:4]:
        store.outbox.put(job.id, Delivery())
    a_day = Settings(retention_s=DAY_S)
    assert removed(store, jobs, a_day) == [False] * 4 + [True] * 3
    store.outbox.remove(jobs[1].id)
    assert removed(store, jobs, a_day) == [False, True, False, False, True, True, True]


def test_a_step_removes_a_few_jobs_and_the_next_one_goes_on(store: JobStore, few_at_once: None) -> None:
    del few_at_once
    jobs = [ended(store, age) for age in (5, 4, 3)]
    retention = Retention(store, Settings(retention_s=DAY_S), Census(store.ended, 2))
    assert retention.step(time.time())
    assert [store.records.job(job.id) is None for job in jobs] == [True, True, False]
    assert not retention.step(time.time())
    assert store.records.job(jobs[2].id) is None


def test_an_entry_without_a_job_is_removed(store: JobStore) -> None:
    job = ended(store, 3)
    store.objects.delete(f"jobs/{job.id}/job.json")
    assert removed(store, [job], Settings(retention_s=DAY_S)) == [True]
    assert store.ended.oldest("", 10) == []


def test_a_count_in_several_steps_is_complete(store: JobStore, few_at_once: None) -> None:
    del few_at_once
    for age in range(5):
        ended(store, age)
    census = Census(store.ended, 2)
    for _ in range(2):
        assert [census.step() for _ in range(3)] == [False, False, True]
        assert census.result == Stored(5, 5 * SIZE)


def test_a_job_that_is_removed_during_a_count_is_not_counted(store: JobStore, few_at_once: None) -> None:
    del few_at_once
    for age in range(5):
        ended(store, 5 - age)
    census = Census(store.ended, 2)
    census.step()
    first = store.ended.oldest("", 1)[0]
    store.delete(first.id)
    census.removed(first)
    assert [census.step(), census.step()] == [False, True]
    assert census.result == Stored(4, 4 * SIZE)


@pytest.mark.parametrize(("settings", "counts"), [({"retention_bytes": 10**9}, 3), ({"retention_s": 9.0}, 2), ({}, 2)])
def test_the_jobs_are_counted_rarely(
    store: JobStore, connection: Redis, monkeypatch: pytest.MonkeyPatch, settings: dict[str, float], counts: int
) -> None:
    """Twice a minute if their size is limited, and once an hour for the metrics."""
    steps: list[bool] = []
    step = Census.step

    def counted(census: Census) -> bool:
        steps.append(True)
        return step(census)

    monkeypatch.setattr(Census, "step", counted)
    counters = JobCounters(connection)
    assert counters.stored() is None
    housekeeping = Housekeeping(store, Settings(**settings), counters)
    for at_s in (0.0, 1.0, 29.0, 31.0, 32.0, 3601.0):
        housekeeping.sweep(at_s)
    assert len(steps) == counts
    assert counters.stored() == Stored(0, 0)


def test_the_size_of_the_ended_jobs_is_noted_for_the_metrics(store: JobStore, connection: Redis) -> None:
    ended(store, 0)
    accepted(store, b"waits")
    counters = JobCounters(connection)
    Housekeeping(store, Settings(), counters).sweep(0.0)
    assert counters.stored() == Stored(1, SIZE)


def test_work_that_fails_is_repeated_after_a_pause(
    store: JobStore, connection: Redis, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A sweep that fails forgets which jobs are missing, so it must not fail each time."""
    housekeeping = Housekeeping(store, Settings(), JobCounters(connection))
    housekeeping.sweep(0.0)

    def fail(age_s: float) -> None:
        raise OSError(f"nothing older than {age_s} s can be deleted")

    monkeypatch.setattr(store, "finish_deletions", fail)
    with pytest.raises(OSError, match="can be deleted"):
        housekeeping.sweep(31.0)
    housekeeping.sweep(33.0)
    with pytest.raises(OSError, match="can be deleted"):
        housekeeping.sweep(62.0)
