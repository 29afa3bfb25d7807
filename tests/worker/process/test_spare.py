"""The spare work-horse of a real worker: it waits for the next job, and runs that one alone."""

import os
import signal
import time

from helpers.jobs import SMALL, accepted, sphere
from helpers.processes import StartWorker, is_alive, spares_of
from helpers.waiting import wait_until
from worker.jobs.job import Failed
from worker.jobs.queue.queue import JobQueue
from worker.jobs.store.store import JobStore

# Fails every job with its process, and the ids of the jobs that this process has run.
_PROGRAM = """
import os
from worker.jobs.job import Failed, now
from worker.process import process
ran = []
def perform(store, settings, job_id, *_):
    ran.append(job_id)
    store.finish(job_id, Failed(finished_at=now(), code="internal_error", message=f"{os.getpid()} {' '.join(ran)}"))
process.perform = perform
process.main()
"""
# Cannot segment a small mesh in a child process, for example because of its limit on memory.
_NOT_PREPARED = f"""
import os, segcore
parent, warm_up = os.getpid(), segcore.warm_up
def in_parent_alone(*groups):
    if os.getpid() != parent:
        raise MemoryError
    warm_up(*groups)
segcore.warm_up = in_parent_alone
{_PROGRAM}
"""


def run(store: JobStore, queue: JobQueue) -> tuple[int, str, list[str]]:
    """Run a job; return the process that has run it, its id, and the jobs that the process has run."""
    job = accepted(store, sphere(4))
    queue.enqueue(job.id, SMALL)
    wait_until(lambda: store.records.outcome(job.id))
    outcome = store.records.outcome(job.id)
    assert isinstance(outcome, Failed)
    assert [attempt.cause for attempt in store.records.attempts(job.id)] == [None]
    pid, *ran = outcome.message.split()
    return int(pid), job.id, ran


def the_spare(worker: int) -> int:
    wait_until(lambda: spares_of(worker))
    (spare,) = spares_of(worker)
    return spare


def niceness_of(pid: int) -> int:
    return os.getpriority(os.PRIO_PROCESS, pid)


def test_a_job_runs_in_the_process_that_waited_for_it_and_each_in_another_one(
    start_worker: StartWorker, store: JobStore, queue: JobQueue
) -> None:
    worker = start_worker(program=("-c", _PROGRAM))
    first = the_spare(worker.pid)
    wait_until(lambda: niceness_of(first) > niceness_of(worker.pid))
    pid, job_id, ran = run(store, queue)
    assert (pid, ran) == (first, [job_id])
    wait_until(lambda: not is_alive(first))
    second = the_spare(worker.pid)
    pid, job_id, ran = run(store, queue)
    assert (pid, ran) == (second, [job_id])


def test_a_spare_that_is_killed_costs_no_attempt_and_none_outlives_its_worker(
    start_worker: StartWorker, store: JobStore, queue: JobQueue
) -> None:
    worker = start_worker(program=("-c", _PROGRAM))
    killed = the_spare(worker.pid)
    os.kill(killed, signal.SIGKILL)
    wait_until(lambda: not is_alive(killed))
    pid, job_id, ran = run(store, queue)
    assert pid != killed
    assert ran == [job_id]
    orphan = the_spare(worker.pid)
    worker.kill()
    wait_until(lambda: not is_alive(orphan), within_s=10)
    stopped = start_worker(program=("-c", _PROGRAM))
    left = the_spare(stopped.pid)
    stopped.send_signal(signal.SIGTERM)
    assert stopped.wait(30) == 0
    assert not is_alive(left)


def test_a_spare_that_cannot_be_prepared_runs_its_job(
    start_worker: StartWorker, store: JobStore, queue: JobQueue
) -> None:
    worker = start_worker(program=("-c", _NOT_PREPARED))
    spare = the_spare(worker.pid)
    time.sleep(0.5)  # more than it waits for a job before it prepares
    assert run(store, queue)[0] == spare
