"""A real worker process with its store in a bucket, and on a full disk."""

import os
import signal
import time
from pathlib import Path

from helpers.buckets import s3_server
from helpers.jobs import LONG, accepted, sphere, unfinished
from helpers.processes import StartWorker, horses_of
from helpers.waiting import wait_until
from worker.jobs.job import Succeeded
from worker.jobs.queue.queue import JobQueue
from worker.jobs.queue.workers import worker_counts
from worker.jobs.size_class import SizeClass
from worker.jobs.store.opening import open_folder, open_url
from worker.jobs.store.store import JobStore


def submitted(store: JobStore, queue: JobQueue, mesh: bytes, **parameters: object) -> str:
    job = accepted(store, mesh, **parameters)
    queue.enqueue(job.id, SizeClass.SMALL)
    return job.id


def succeeds(store: JobStore, job_id: str) -> bool:
    wait_until(lambda: store.records.outcome(job_id))
    return isinstance(store.records.outcome(job_id), Succeeded)


def test_a_worker_runs_jobs_of_a_bucket_even_if_the_bucket_hangs_meanwhile(
    start_worker: StartWorker, queue: JobQueue, tmp_path: Path, s3_url: str
) -> None:
    del s3_url  # the credentials
    with s3_server() as (url, server):
        store = open_url(url, tmp_path / "service", 2**20)
        worker = start_worker(CLEAVE_STORE_URL=url)
        jobs = [submitted(store, queue, sphere(20)), submitted(store, queue, b"no mesh")]
        assert succeeds(store, jobs[0])
        assert not succeeds(store, jobs[1])
        with store.results.open(jobs[0]) as result:
            assert result.read(4)
        jobs.append(submitted(store, queue, sphere(100), **LONG))
        wait_until(lambda: horses_of(worker.pid))
        os.kill(server.pid, signal.SIGSTOP)
        time.sleep(4)
        os.kill(server.pid, signal.SIGCONT)
        assert succeeds(store, jobs[2])
        assert unfinished(store) == {}
        assert [len(store.records.attempts(job_id)) for job_id in jobs] == [1, 1, 1]
        wait_until(lambda: list((tmp_path / "data" / "incoming").iterdir()) == [])
        assert worker.poll() is None


def test_on_a_full_disk_a_job_waits_and_does_not_fail(
    start_worker: StartWorker, queue: JobQueue, small_disk: Path
) -> None:
    store = open_folder(small_disk)
    job_id = submitted(store, queue, sphere(60))
    ballast = small_disk / "ballast"
    status = os.statvfs(small_disk)
    ballast.write_bytes(bytes(status.f_bavail * status.f_frsize))
    worker = start_worker()
    wait_until(lambda: any(worker_counts(queue.connection).values()))
    time.sleep(3)
    assert store.records.attempts(job_id) == []
    os.truncate(ballast, ballast.stat().st_size - 24 * 1024)  # room for records, not for a result
    wait_until(lambda: store.records.attempts(job_id))
    wait_until(lambda: not store.records.attempts(job_id))
    assert store.records.outcome(job_id) is None
    ballast.unlink()
    assert succeeds(store, job_id)
    assert len(store.records.attempts(job_id)) == 1
    assert worker.poll() is None
