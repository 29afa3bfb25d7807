"""Progress of a job: durations of stages, and reports to the queue."""

import pytest

from helpers.waiting import wait_until
from worker.jobs.job import new_job_id
from worker.jobs.queue.connection import connect
from worker.jobs.queue.queue import JobQueue, Progress
from worker.process.progress import ProgressReporter, StageClock


def test_a_stage_clock_measures_every_stage_and_calls_the_other_callback() -> None:
    times = iter([0.0, 1.0, 1.0, 4.0, 4.0, 6.0])
    seen: list[tuple[str, float]] = []
    clock = StageClock(lambda stage, fraction: seen.append((stage, fraction)), lambda: next(times))
    clock("reading", 0.0)
    clock("cut", 0.1)
    clock("cut", 0.2)
    clock.begin("storing")
    assert clock.stop() == {"reading": 1.0, "cut": 3.0, "storing": 2.0}
    assert seen == [("reading", 0.0), ("cut", 0.1), ("cut", 0.2)]


def test_reports_go_to_the_queue_at_every_stage_and_a_few_times_a_second(queue: JobQueue) -> None:
    job_id = new_job_id()
    queue.take(job_id, "worker", lease_s=30)
    report = ProgressReporter(queue, job_id)
    report("clean", 0.1)
    report("coarsen", 0.2)
    report("coarsen", 0.25)
    assert queue.activity(job_id).progress == Progress("coarsen", 0.2)

    def is_reported() -> bool:
        report("coarsen", 0.3)
        return queue.activity(job_id).progress == Progress("coarsen", 0.3)

    wait_until(is_reported, within_s=10)


def test_after_an_error_of_redis_nothing_is_reported_for_some_seconds(monkeypatch: pytest.MonkeyPatch) -> None:
    queue = JobQueue(connect("unix:///nowhere/queue.sock", timeout_s=0.1))
    report = ProgressReporter(queue, new_job_id())
    report("clean", 0.1)
    monkeypatch.setattr(queue, "publish", lambda *_: pytest.fail("it was reported"))
    report("cut", 0.3)
