"""JobCounters: what many processes count together, and nobody waits for."""

from datetime import timedelta

from redis import Redis

from helpers.jobs import accepted
from worker.jobs.job import Failed, Succeeded
from worker.jobs.queue.connection import connect
from worker.jobs.queue.counters import BOUNDS_S, JobCounters, durations
from worker.jobs.store.store import JobStore


def test_jobs_are_counted_by_their_outcome_with_faces_and_durations(connection: Redis, store: JobStore) -> None:
    job = accepted(store, b"mesh")
    end = job.created_at + timedelta(seconds=2)
    done = Succeeded(finished_at=end, faces=500, vertices=252, max_segments=9, automatic_segments=4)
    JobCounters(connection).job_ended(job, done, {"cut": 0.2, "label": 5000.0})
    JobCounters(connection).job_ended(job, done, {"cut": 0.2})
    JobCounters(connection).job_ended(job, Failed(finished_at=end, code="invalid_mesh", message="."), {})
    counts = JobCounters(connection).counts()
    assert counts["finished", "succeeded", ""] == 2
    assert counts["finished", "failed", "invalid_mesh"] == 1
    assert counts["faces",] == 1000
    cut, label, whole = (durations(counts, name) for name in (("stage", "cut"), ("stage", "label"), ("job",)))
    assert cut.counts[BOUNDS_S.index(0.3)] == sum(cut.counts) == 2
    assert abs(cut.sum_s - 0.4) < 1e-9
    assert label.counts[-1] == 1
    assert (sum(whole.counts), whole.sum_s) == (3, 6)


def test_other_events_are_counted_by_their_label(connection: Redis) -> None:
    counters = JobCounters(connection)
    counters.attempt_lost("worker_lost")
    counters.attempt_lost("out_of_memory")
    counters.attempt_lost("worker_lost")
    counters.job_given_up("worker_lost")
    counters.job_recovered()
    counters.store_failed("worker")
    assert counters.counts() == {
        ("lost", "worker_lost"): 2,
        ("lost", "out_of_memory"): 1,
        ("finished", "failed", "worker_lost"): 1,
        ("recovered",): 1,
        ("store_errors", "worker"): 1,
    }


def test_counting_without_redis_is_ignored() -> None:
    with connect("unix:///nowhere/queue.sock", timeout_s=0.1) as gone:
        JobCounters(gone).job_recovered()
