"""Real worker processes: what they run and refuse, and what happens to a job if a process dies."""

import os
import pickle
import signal
import subprocess
import time
from pathlib import Path

import pytest
from redis import Redis

from helpers.jobs import LARGE, LONG, SMALL, accepted, sphere
from helpers.processes import StartWorker, horses_of, is_alive, spares_of
from helpers.waiting import wait_until
from worker.jobs.job import Canceled, Failed, Job, Outcome, Succeeded, now
from worker.jobs.queue.entries import FUNCTION_NAME
from worker.jobs.queue.queue import JobQueue
from worker.jobs.queue.workers import worker_counts
from worker.jobs.store.store import JobStore


def outcome_of(store: JobStore, job: Job, within_s: float = 60.0) -> Outcome:
    wait_until(lambda: store.records.outcome(job.id), within_s)
    outcome = store.records.outcome(job.id)
    assert outcome is not None
    return outcome


def horse_of(worker: "subprocess.Popen[bytes]") -> int:
    """Wait for the work-horse of a worker and return its process id."""
    wait_until(lambda: horses_of(worker.pid))
    return horses_of(worker.pid)[0]


def submitted(store: JobStore, queue: JobQueue, **parameters: object) -> Job:
    job = accepted(store, sphere(100 if parameters else 20), **parameters)
    queue.enqueue(job.id, SMALL)
    return job


def test_a_queued_job_succeeds_and_no_key_remains_in_redis(
    start_worker: StartWorker, store: JobStore, queue: JobQueue, connection: Redis
) -> None:
    worker = start_worker()
    job = submitted(store, queue)
    assert isinstance(outcome_of(store, job), Succeeded)
    wait_until(lambda: not [key for key in connection.scan_iter() if job.id.encode() in key])
    assert worker_counts(queue.connection) == {SMALL: 1, LARGE: 0}
    worker.send_signal(signal.SIGTERM)
    assert worker.wait(30) == 0
    assert worker_counts(queue.connection) == {SMALL: 0, LARGE: 0}


def test_a_running_job_shows_its_stage_and_progress(
    start_worker: StartWorker, store: JobStore, queue: JobQueue
) -> None:
    start_worker()
    job = submitted(store, queue, **LONG)
    wait_until(lambda: queue.activity(job.id).progress)
    activity = queue.activity(job.id)
    assert activity.running
    assert activity.progress is not None
    assert 0 <= activity.progress.fraction <= 1


def test_entries_that_name_another_callable_are_dropped_unrun(
    start_worker: StartWorker, store: JobStore, queue: JobQueue, connection: Redis, tmp_path: Path
) -> None:
    job = accepted(store, sphere(20))
    touched = tmp_path / "touched"
    queue.entries[SMALL].enqueue("os.system", f"touch {touched}", job_id=job.id)
    queue.entries[SMALL].enqueue(FUNCTION_NAME, "x", job_id="not-a-job-id")
    queue.entries[SMALL].enqueue(FUNCTION_NAME, job.id, job_id="0" * 32)
    pickled = pickle.dumps(("os.system", None, (f"touch {touched}",), {}))
    connection.hset("rq:job:pickled", mapping={"data": pickled, "created_at": "2026-01-01T00:00:00.000000Z"})
    connection.rpush(queue.entries[SMALL].key, "pickled")
    last = submitted(store, queue)
    start_worker()
    assert isinstance(outcome_of(store, last), Succeeded)
    assert not touched.exists()
    assert store.records.attempts(job.id) == []
    assert queue.entries[SMALL].get_job_ids() == []


def test_a_killed_work_horse_costs_an_attempt_and_not_the_job(
    start_worker: StartWorker, store: JobStore, queue: JobQueue
) -> None:
    worker = start_worker()
    job = submitted(store, queue, **LONG)
    os.kill(horse_of(worker), signal.SIGKILL)
    assert isinstance(outcome_of(store, job), Succeeded)
    assert [attempt.cause for attempt in store.records.attempts(job.id)] == ["worker_lost", None]


def test_the_queue_gives_no_job_to_a_worker_that_has_just_been_killed(
    start_worker: StartWorker, queue: JobQueue
) -> None:
    worker = start_worker()
    wait_until(lambda: any(worker_counts(queue.connection).values()))
    wait_until(lambda: spares_of(worker.pid))
    (spare,) = spares_of(worker.pid)
    assert sockets_of(worker.pid)
    wait_until(lambda: not sockets_of(worker.pid) & sockets_of(spare))
    worker.kill()
    worker.wait()
    queue.enqueue("f" * 32, SMALL)
    time.sleep(0.5)
    assert queue.entries[SMALL].get_job_ids() == ["f" * 32]


def sockets_of(pid: int) -> set[str]:
    """Return the sockets that a process has open."""
    names = [os.readlink(file) for file in Path(f"/proc/{pid}/fd").iterdir() if file.is_symlink()]
    return {name for name in names if name.startswith("socket")}


def poison(statement: str) -> tuple[str, str]:
    """Return a worker program that runs a statement for the mesh b"poison", and cancels every other job.

    It needs no kernels, which take most of the start of a worker.
    """
    source = f"""
import ctypes, os, tempfile
from worker.jobs.job import Canceled, now
from worker.process import process
class NoKernels:
    def __init__(self, connection):
        pass
    def load_first(self):
        pass
    def load_others(self):
        return False
def perform(store, settings, job_id, *_):
    if store.open_mesh(job_id).read() == b"poison":
        {statement}
    store.finish(job_id, Canceled(finished_at=now()))
process.perform = perform
process.WorkerKernels = NoKernels
process.main()
"""
    return "-c", source


@pytest.mark.parametrize(
    ("statement", "code", "limit"),
    [
        ("os.kill(os.getpid(), 9)", "worker_lost", {}),
        ("os.abort()", "worker_lost", {}),
        ("bytearray(2**31)", "out_of_memory", {"CLEAVE_JOB_MEMORY_BYTES": str(2**31)}),
        # In C and with the interpreter locked, so that no signal handler of Python runs.
        ("ctypes.PyDLL(None).sleep(1000)", "timed_out", {"CLEAVE_JOB_TIMEOUT_S": "0.5"}),
        ("while True: pass", "timed_out", {"CLEAVE_JOB_CPU_S": "1"}),
        ("tempfile.TemporaryFile().write(bytes(2**22))", "file_too_large", {"CLEAVE_JOB_FILE_BYTES": str(2**21)}),
        ("1 / 0", "internal_error", {}),
    ],
)
def test_poison_ends_as_failed_after_three_attempts_and_the_worker_goes_on(
    start_worker: StartWorker, store: JobStore, queue: JobQueue, statement: str, code: str, limit: dict[str, str]
) -> None:
    worker = start_worker(program=poison(statement), **limit)
    job = accepted(store, b"poison")
    queue.enqueue(job.id, SMALL)
    outcome = outcome_of(store, job)
    assert isinstance(outcome, Failed)
    assert outcome.code == code
    assert [attempt.cause for attempt in store.records.attempts(job.id)] == [code] * 3
    assert isinstance(outcome_of(store, submitted(store, queue)), Canceled)
    assert worker.poll() is None


def test_an_invalid_input_costs_one_attempt(start_worker: StartWorker, store: JobStore, queue: JobQueue) -> None:
    start_worker()
    jobs = [accepted(store, mesh) for mesh in (b"OFF\n1 0 0\n0 0 0\n", b"what is this", sphere(20)[:-50])]
    for job in jobs:
        queue.enqueue(job.id, SMALL)
    codes = [getattr(outcome_of(store, job), "code", None) for job in jobs]
    assert codes == ["invalid_mesh", "unsupported_format", "invalid_mesh"]
    assert [len(store.records.attempts(job.id)) for job in jobs] == [1, 1, 1]


def test_a_job_that_needs_too_much_memory_is_stopped_with_a_reason(
    start_worker: StartWorker, store: JobStore, queue: JobQueue
) -> None:
    start_worker(CLEAVE_MAX_ATTEMPTS="1", CLEAVE_JOB_MEMORY_BYTES=str(400 * 2**20))
    outcome = outcome_of(store, accepted_large(store, queue))
    assert isinstance(outcome, Failed)
    assert outcome.code == "out_of_memory"


def accepted_large(store: JobStore, queue: JobQueue) -> Job:
    job = accepted(store, sphere(300))
    queue.enqueue(job.id, SMALL)
    return job


def test_a_canceled_job_stops_within_seconds(start_worker: StartWorker, store: JobStore, queue: JobQueue) -> None:
    worker = start_worker()
    job = submitted(store, queue, **LONG)
    horse = horse_of(worker)
    store.finish(job.id, Canceled(finished_at=now()))
    wait_until(lambda: not is_alive(horse), within_s=10)
    assert isinstance(store.records.outcome(job.id), Canceled)
    assert isinstance(outcome_of(store, submitted(store, queue)), Succeeded)


def test_a_deleted_job_stops_and_the_worker_goes_on(
    start_worker: StartWorker, store: JobStore, queue: JobQueue
) -> None:
    worker = start_worker()
    job = submitted(store, queue, **LONG)
    horse = horse_of(worker)
    store.delete(job.id)
    wait_until(lambda: not is_alive(horse), within_s=10)
    assert isinstance(outcome_of(store, submitted(store, queue)), Succeeded)


@pytest.mark.parametrize("to_group", [False, True])
def test_a_stopped_worker_requeues_its_job(
    start_worker: StartWorker, store: JobStore, queue: JobQueue, to_group: bool
) -> None:
    worker = start_worker(CLEAVE_SHUTDOWN_GRACE_S="0")
    job = submitted(store, queue, **LONG)
    horse = horse_of(worker)
    wait_until(lambda: queue.activity(job.id).progress)
    if to_group:
        os.kill(horse, signal.SIGTERM)
    worker.send_signal(signal.SIGTERM)
    assert worker.wait(30) == 0
    assert not is_alive(horse)
    assert store.records.outcome(job.id) is None
    assert store.records.attempts(job.id) == []
    assert queue.entries[SMALL].get_job_ids() == [job.id]


def test_a_stopped_worker_lets_a_job_end_within_the_grace_time(
    start_worker: StartWorker, store: JobStore, queue: JobQueue
) -> None:
    worker = start_worker(CLEAVE_SHUTDOWN_GRACE_S="120")
    job = submitted(store, queue, **LONG)
    horse_of(worker)
    worker.send_signal(signal.SIGTERM)
    assert worker.wait(120) == 0
    assert isinstance(store.records.outcome(job.id), Succeeded)


def test_a_killed_worker_takes_its_work_horse_along(
    start_worker: StartWorker, store: JobStore, queue: JobQueue
) -> None:
    worker = start_worker()
    job = submitted(store, queue, **LONG)
    horse = horse_of(worker)
    worker.kill()
    wait_until(lambda: not is_alive(horse), within_s=10)
    assert store.records.outcome(job.id) is None


def test_a_job_whose_lease_another_worker_holds_is_not_run(
    start_worker: StartWorker, store: JobStore, queue: JobQueue
) -> None:
    held = accepted(store, sphere(20))
    queue.take(held.id, "another", lease_s=30)
    queue.enqueue(held.id, SMALL)
    other = submitted(store, queue)
    start_worker()
    assert isinstance(outcome_of(store, other), Succeeded)
    assert store.records.attempts(held.id) == []


def test_a_large_job_does_not_delay_small_ones(start_worker: StartWorker, store: JobStore, queue: JobQueue) -> None:
    start_worker(SMALL)
    worker = start_worker(LARGE)
    large = accepted(store, sphere(100), **LONG)
    queue.enqueue(large.id, LARGE)
    os.kill(horse_of(worker), signal.SIGSTOP)  # so that it runs until the end of the test
    for _ in range(3):
        assert isinstance(outcome_of(store, submitted(store, queue)), Succeeded)
    assert queue.activity(large.id).running
    assert store.records.outcome(large.id) is None


def test_what_passes_through_redis_is_small(
    start_worker: StartWorker, store: JobStore, queue: JobQueue, connection: Redis
) -> None:
    start_worker()
    job = submitted(store, queue, **LONG)
    largest = 0
    while store.records.outcome(job.id) is None:
        largest = max([largest, *(connection.memory_usage(key) or 0 for key in connection.scan_iter())])
        time.sleep(0.1)
    assert 0 < largest < 10_000
