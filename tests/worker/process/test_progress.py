"""Progress of a job: durations of stages, reports of work-horses, and their publication."""

import os
import select
from collections.abc import Iterator

import numpy as np
import pytest

from helpers.waiting import wait_until
from worker.jobs.job import new_job_id
from worker.jobs.queue.connection import connect
from worker.jobs.queue.queue import JobQueue, Progress
from worker.process.progress import ProgressPublisher, ProgressReports, StageClock


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


@pytest.fixture
def pipe() -> Iterator[tuple[int, int]]:
    reader, writer = os.pipe()
    os.set_blocking(writer, False)
    yield reader, writer
    os.close(reader)
    os.close(writer)


def test_every_stage_is_reported_and_progress_within_one_a_few_times_a_second(pipe: tuple[int, int]) -> None:
    reader, writer = pipe
    report = ProgressReports(writer)
    report("clean", np.float64(0.1))
    report("coarsen", 0.2)
    report("coarsen", 0.25)
    assert os.read(reader, 1000) == b"clean 0.1\ncoarsen 0.2\n"

    def is_reported() -> bool:
        report("coarsen", 0.3)
        return bool(select.select([reader], [], [], 0)[0])

    wait_until(is_reported, within_s=10)
    assert os.read(reader, 1000) == b"coarsen 0.3\n"


def test_a_report_that_nobody_reads_or_that_has_no_room_stops_no_job(pipe: tuple[int, int]) -> None:
    reader, writer = pipe
    report = ProgressReports(writer)
    for number in range(20_000):
        report(f"stage{number}", 0.5)
    assert os.read(reader, 1_000_000).splitlines()[:2] == [b"stage0 0.5", b"stage1 0.5"]
    unread, closed = os.pipe()
    os.close(unread)
    ProgressReports(closed)("clean", 0.1)
    os.close(closed)


def test_the_last_report_is_published(queue: JobQueue) -> None:
    job_id = new_job_id()
    queue.take(job_id, "worker", lease_s=30)
    ProgressPublisher(queue, job_id)(b"clean 0.1\ncoarsen 0.30000000000000004\n")
    assert queue.activity(job_id).progress == Progress("coarsen", 0.1 + 0.2)


def test_after_an_error_of_redis_nothing_is_published_for_some_seconds(monkeypatch: pytest.MonkeyPatch) -> None:
    queue = JobQueue(connect("unix:///nowhere/queue.sock", timeout_s=0.1))
    publish = ProgressPublisher(queue, new_job_id())
    publish(b"clean 0.1\n")
    monkeypatch.setattr(queue, "publish", lambda *_: pytest.fail("it was published"))
    publish(b"cut 0.3\n")
