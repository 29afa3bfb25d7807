"""Entries of the queue: valid ones, and those of an earlier version during an upgrade."""

from collections.abc import Callable

import pytest
from redis import Redis

from helpers.jobs import SMALL, accepted, sphere, unfinished
from helpers.processes import StartWorker
from helpers.waiting import wait_until
from worker.jobs.job import Succeeded, new_job_id
from worker.jobs.queue.entries import FUNCTION_NAME, is_valid
from worker.jobs.queue.queue import JobQueue
from worker.jobs.store.store import JobStore

EARLIER_NAME = "worker.tasks.perform"


def test_an_enqueued_job_has_a_valid_entry(queue: JobQueue) -> None:
    job_id = new_job_id()
    queue.enqueue(job_id, SMALL)
    assert is_valid(queue.entries[SMALL].fetch_job(job_id))


@pytest.mark.parametrize(
    ("name", "arguments", "keywords"),
    [
        (EARLIER_NAME, ["ID"], {}),
        ("os.system", ["ID"], {}),
        (FUNCTION_NAME, [], {}),
        (FUNCTION_NAME, ["another"], {}),
        (FUNCTION_NAME, ["ID", "ID"], {}),
        (FUNCTION_NAME, ["ID"], {"keyword": 1}),
    ],
)
def test_every_other_entry_is_invalid(
    queue: JobQueue, name: str, arguments: list[str], keywords: dict[str, int]
) -> None:
    job_id = new_job_id()
    arguments = [job_id if argument == "ID" else argument for argument in arguments]
    entry = queue.entries[SMALL].enqueue_call(name, args=arguments, kwargs=keywords, job_id=job_id)
    assert not is_valid(queue.entries[SMALL].fetch_job(entry.id))


@pytest.mark.slow
def test_a_job_that_an_earlier_version_has_enqueued_is_dropped_unrun_and_then_finished(
    start_worker: StartWorker,
    start_janitor: Callable[[], None],
    store: JobStore,
    queue: JobQueue,
    connection: Redis,
) -> None:
    job = accepted(store, sphere(20))
    queue.entries[SMALL].enqueue(
        EARLIER_NAME, job.id, job_id=job.id, unique=True, at_front=False, job_timeout=-1, result_ttl=0
    )
    start_worker()
    wait_until(lambda: not [key for key in connection.scan_iter() if job.id.encode() in key])
    assert store.records.attempts(job.id) == []
    assert store.records.outcome(job.id) is None
    start_janitor()
    wait_until(lambda: store.records.outcome(job.id))
    assert isinstance(store.records.outcome(job.id), Succeeded)
    assert len(store.records.attempts(job.id)) == 1
    assert unfinished(store) == {}
    wait_until(lambda: queue.held([job.id]) == set())
