"""Metrics that all services share: of the store, the queue and the workers."""

from datetime import timedelta

import httpx
import pytest

from cleave.settings import Settings
from helpers.api import samples, submit
from helpers.jobs import SMALL
from worker.jobs.job import now
from worker.jobs.queue.counters import JobCounters
from worker.jobs.queue.queue import JobQueue, Progress
from worker.jobs.store.pending import PendingJobs
from worker.jobs.store.store import JobStore
from worker.process.perform import perform


def test_running_jobs_are_counted_by_their_stage(client: httpx.Client, queue: JobQueue) -> None:
    first, second = (submit(client).rpartition("/")[2] for _ in range(2))
    for job_id in (first, second):
        queue.take(job_id, "worker", lease_s=30)
    queue.publish(first, Progress("cut", 0.5))
    found = samples(client)
    assert found['cleave_running_jobs{stage="cut"}'] == found['cleave_running_jobs{stage="starting"}'] == 1


def test_the_age_of_a_queue_is_that_of_its_next_job(client: httpx.Client, queue: JobQueue) -> None:
    assert samples(client)['cleave_queue_age_seconds{queue="small"}'] == 0
    submit(client)
    assert 0 < samples(client)['cleave_queue_age_seconds{queue="small"}'] < 60
    assert queue.ages_s(now() + timedelta(hours=1))[SMALL] > 3600
    assert queue.ages_s(now() - timedelta(hours=1))[SMALL] == 0


def test_every_service_reports_the_counters_of_the_workers(
    client: httpx.Client, queue: JobQueue, store: JobStore, settings: Settings
) -> None:
    job_id = submit(client).rpartition("/")[2]
    work = perform(store, settings, job_id, lambda *_: None)
    assert work is not None
    counters = JobCounters(queue.connection)
    counters.job_ended(work.job, work.outcome, work.stage_seconds)
    counters.attempt_lost("worker_lost")
    counters.job_recovered()
    counters.store_failed("worker")
    found = samples(client)
    assert found['cleave_jobs_finished_total{code="",status="succeeded"}'] == 1
    assert found["cleave_faces_total"] == 4 * 12 * 11
    assert found['cleave_lost_attempts_total{cause="worker_lost"}'] == found["cleave_recovered_jobs_total"] == 1
    assert found['cleave_store_errors_total{process="worker"}'] == 1
    assert found["cleave_job_seconds_count"] == found['cleave_job_seconds_bucket{le="+Inf"}'] == 1
    stages = {name.split('"')[1] for name in found if name.startswith("cleave_stage_seconds_count")}
    assert stages >= {"reading", "affinity", "cut", "label", "storing"}
    for stage in stages:
        buckets = [
            value for name, value in found.items() if name.startswith("cleave_stage_seconds_bucket") and stage in name
        ]
        assert buckets == sorted(buckets)


def test_a_store_that_fails_is_reported_and_the_other_metrics_remain(
    client: httpx.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise OSError(5, "Input/output error")

    monkeypatch.setattr(PendingJobs, "count", fail)
    monkeypatch.setattr(JobStore, "check_writable", fail)
    client.get("/readyz")
    found = samples(client)
    assert (found["cleave_store_up"], found["cleave_queue_up"]) == (0, 1)
    assert found['cleave_store_errors_total{process="service"}'] == 2


def test_repeated_cancels_of_a_job_count_once(client: httpx.Client) -> None:
    path = submit(client)
    for _ in range(2):
        client.post(f"{path}/cancel")
    client.delete(path)
    client.delete(submit(client))
    assert samples(client)['cleave_jobs_finished_total{code="",status="canceled"}'] == 2
