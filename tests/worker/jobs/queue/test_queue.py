"""The queue: every job waits once, a lease has one holder, and no keys remain afterwards."""

import pytest
from redis import Redis

from helpers.jobs import LARGE, SMALL
from helpers.waiting import wait_until
from worker.jobs.job import new_job_id
from worker.jobs.queue.connection import QueueError, connect
from worker.jobs.queue.queue import Activity, JobQueue, Progress


def waiting(queue: JobQueue) -> list[str]:
    ids: list[str] = queue.entries[SMALL].get_job_ids()
    return ids


def test_a_job_waits_once_however_often_it_is_enqueued(queue: JobQueue) -> None:
    job_id = new_job_id()
    queue.enqueue(job_id, SMALL)
    queue.enqueue(job_id, SMALL)
    queue.requeue(job_id, SMALL)
    assert waiting(queue) == [job_id]


def test_jobs_wait_in_the_order_of_their_arrival_except_those_put_at_the_front(queue: JobQueue) -> None:
    first, second, returned = new_job_id(), new_job_id(), new_job_id()
    queue.enqueue(first, SMALL)
    queue.enqueue(second, SMALL)
    queue.enqueue(returned, SMALL, at_front=True)
    assert waiting(queue) == [returned, first, second]


def test_a_job_whose_entry_is_stuck_can_be_requeued(queue: JobQueue, connection: Redis) -> None:
    job_id = new_job_id()
    queue.enqueue(job_id, SMALL)
    entries = queue.entries[SMALL]
    connection.blmove(entries.key, entries.intermediate_queue_key, 1)  # as if a worker had died after the dequeue
    queue.enqueue(job_id, SMALL)
    assert waiting(queue) == []
    assert queue.held([job_id]) == set()
    queue.requeue(job_id, SMALL)
    assert waiting(queue) == [job_id]
    assert connection.llen(entries.intermediate_queue_key) == 0


def test_small_and_large_jobs_have_separate_queues(queue: JobQueue) -> None:
    large, first, second = new_job_id(), new_job_id(), new_job_id()
    for job_id, size in ((large, LARGE), (first, SMALL), (second, SMALL)):
        queue.enqueue(job_id, size)
    positions = {job_id: activity.position for job_id, activity in queue.activities([second, large, first]).items()}
    assert positions == {large: 1, first: 1, second: 2}
    assert queue.lengths() == {SMALL: 2, LARGE: 1}
    assert queue.held([first, second, large]) == {first, second, large}
    queue.forget(large)
    queue.requeue(second, LARGE)  # as if CLEAVE_LARGE_JOB_BYTES had changed
    assert queue.lengths() == {SMALL: 1, LARGE: 1}


def test_a_lease_has_one_holder_until_it_expires(queue: JobQueue) -> None:
    job_id = new_job_id()
    assert queue.take(job_id, "worker-1", lease_s=0.2)
    assert not queue.take(job_id, "worker-2", lease_s=10)
    wait_until(lambda: queue.take(job_id, "worker-2", lease_s=10), within_s=10)


def test_only_its_holder_releases_a_lease(queue: JobQueue) -> None:
    job_id = new_job_id()
    queue.take(job_id, "worker-1", lease_s=10)
    queue.release(job_id, "worker-2")
    assert queue.activity(job_id).running
    queue.release(job_id, "worker-1")
    assert not queue.activity(job_id).running


def test_jobs_that_wait_or_run_are_held(queue: JobQueue) -> None:
    waits, runs, lost = new_job_id(), new_job_id(), new_job_id()
    queue.enqueue(waits, SMALL)
    queue.enqueue(new_job_id(), SMALL)
    queue.take(runs, "worker", lease_s=10)
    assert queue.held([waits, runs, lost]) == {waits, runs}
    assert queue.held([]) == set()


def test_a_lease_that_redis_has_lost_is_restored(queue: JobQueue, connection: Redis) -> None:
    job_id = new_job_id()
    queue.take(job_id, "worker", lease_s=10)
    connection.flushall()
    queue.renew(job_id, "worker", lease_s=10)
    assert queue.held([job_id]) == {job_id}


def test_running_jobs_have_progress(queue: JobQueue) -> None:
    job_id = new_job_id()
    assert queue.activity(job_id) == Activity(running=False, progress=None)
    queue.take(job_id, "worker", lease_s=10)
    queue.publish(job_id, Progress("coarsen", 0.25))
    assert queue.activity(job_id) == Activity(running=True, progress=Progress("coarsen", 0.25))


def test_no_key_of_a_forgotten_job_remains(queue: JobQueue, connection: Redis) -> None:
    job_id = new_job_id()
    queue.enqueue(job_id, SMALL)
    queue.take(job_id, "worker", lease_s=10)
    queue.publish(job_id, Progress("coarsen", 0.5))
    queue.forget(job_id)
    queue.release(job_id, "worker")
    assert [key for key in connection.scan_iter() if job_id.encode() in key] == []


def test_entries_are_not_pickled(queue: JobQueue, connection: Redis) -> None:
    job_id = new_job_id()
    queue.enqueue(job_id, SMALL)
    entry = connection.hgetall(f"rq:job:{job_id}")
    assert b"\x80\x04" not in entry[b"data"]
    assert queue.entries[SMALL].fetch_job(job_id).args == [job_id]


def test_a_connection_without_a_server_fails_at_once() -> None:
    queue = JobQueue(connect("unix:///nowhere/queue.sock", timeout_s=0.1))
    with pytest.raises(QueueError):
        queue.enqueue(new_job_id(), SMALL)
