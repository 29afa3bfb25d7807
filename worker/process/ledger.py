"""What the store and the queue are told about the runs of jobs by a worker."""

import logging
from contextlib import suppress

from cleave.settings import Settings
from worker.jobs.admission import admit
from worker.jobs.attempts import Attempt, exhausted
from worker.jobs.queue.counters import JobCounters
from worker.jobs.queue.queue import JobQueue
from worker.jobs.size_class import SizeClass
from worker.jobs.store.store import JobStore, UnknownJob
from worker.process.work_horse import Ending

log = logging.getLogger("cleave.worker")


class Ledger:
    """Begins and ends attempts, and leaves the queue as the store says."""

    def __init__(
        self, store: JobStore, queue: JobQueue, counters: JobCounters, settings: Settings, size: SizeClass, worker: str
    ) -> None:
        self._store = store
        self._queue = queue
        self._counters = counters
        self._settings = settings
        self._size = size
        self._worker = worker
        self._uncounted: list[tuple[str, Attempt]] = []  # attempts that the store would not withdraw yet

    def begin(self, job_id: str) -> Attempt | None:
        """Count one more run of a job; None where it must not run: it was deleted, has ended, or now ends as failed."""
        if self._store.records.job(job_id) is None:
            log.warning("job %s is not in the store: it was deleted, or the store is another's", job_id)
        if not self._is_open(job_id):
            return None
        self._withdraw_uncounted()
        failed = exhausted(self._store.records.attempts(job_id), self._settings.max_attempts)
        try:
            if failed is None:
                return self._store.begin_attempt(job_id, self._worker)
            self._store.finish(job_id, failed)
            self._counters.job_given_up(failed.code)
        except UnknownJob:
            log.info("job %s was deleted", job_id)
        return None

    def end(self, job_id: str, attempt: Attempt, ending: Ending) -> None:
        """Note how a run has ended, unless the job has an outcome.

        Raises
        ------
        OSError
            Where the work-horse could not store what it had.
        """
        if not self._is_open(job_id):
            return
        match ending:
            case "shutdown" | "ended elsewhere":
                self._store.records.withdraw_attempt(job_id, attempt)
            case "cannot store":
                raise OSError("what the work-horse wrote could not be stored")
            case cause:
                log.warning("job %s: attempt %d ended with %s", job_id, attempt.number, cause)
                self._counters.attempt_lost(cause)
                self._store.records.end_attempt(job_id, attempt, cause)

    def uncount(self, job_id: str, attempt: Attempt) -> None:
        """Withdraw an attempt, now or, where the store cannot now, before the next one begins."""
        self._uncounted.append((job_id, attempt))
        with suppress(OSError):
            self._withdraw_uncounted()

    def hand_back(self, job_id: str) -> None:
        """Let a job wait again, without a look into the store."""
        self._queue.release(job_id, self._worker)
        self._queue.requeue(job_id, self._size)

    def settle(self, job_id: str) -> None:
        """Leave the queue as the store says: nothing of a job that has ended, another entry for one that has not."""
        outcome = self._store.records.outcome(job_id)
        log.info("job %s: %s", job_id, outcome.status if outcome else "no outcome")
        self._queue.release(job_id, self._worker)
        if self._is_open(job_id):
            self._queue.requeue(job_id, self._size, at_front=True)
        else:
            self._queue.forget(job_id)
            self._admit_next(job_id)

    def _withdraw_uncounted(self) -> None:
        while self._uncounted:
            self._store.records.withdraw_attempt(*self._uncounted[-1])
            self._uncounted.pop()

    def _admit_next(self, job_id: str) -> None:
        """The owner of a job that has ended may have another in the queue."""
        job = self._store.records.job(job_id)
        if job is not None:
            admit(self._store, self._queue, self._settings, job.owner)

    def _is_open(self, job_id: str) -> bool:
        return not self._store.records.has_ended(job_id)
