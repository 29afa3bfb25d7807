"""Records the attempts of a worker in the store, and updates the queue to match."""

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
    """Begins and ends the attempts of one worker, and removes or requeues their jobs."""

    def __init__(
        self, store: JobStore, queue: JobQueue, counters: JobCounters, settings: Settings, size: SizeClass, worker: str
    ) -> None:
        self._store = store
        self._queue = queue
        self._counters = counters
        self._settings = settings
        self._size = size
        self._worker = worker
        self._uncounted: list[tuple[str, Attempt]] = []  # to be withdrawn when the store answers

    def begin(self, job_id: str) -> Attempt | None:
        """Begin an attempt; None if the job must not run: it was deleted, has ended, or has had all its attempts."""
        if self._store.records.job(job_id) is None:
            log.warning("job %s is not in the store: it was deleted, or another installation uses this queue", job_id)
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
        """Record how a run has ended, unless the job has an outcome.

        Raises
        ------
        OSError
            If the work-horse could not store its result.
        """
        if not self._is_open(job_id):
            return
        match ending:
            case "shutdown" | "ended elsewhere":
                self._store.records.withdraw_attempt(job_id, attempt)
            case "cannot store":
                raise OSError("the work-horse could not store its result")
            case cause:
                log.warning("job %s: attempt %d ended with %s", job_id, attempt.number, cause)
                self._counters.attempt_lost(cause)
                self._store.records.end_attempt(job_id, attempt, cause)

    def uncount(self, job_id: str, attempt: Attempt) -> None:
        """Withdraw an attempt, now or, if the store does not answer, before the next attempt begins."""
        self._uncounted.append((job_id, attempt))
        with suppress(OSError):
            self._withdraw_uncounted()

    def hand_back(self, job_id: str) -> None:
        """Requeue a job without reading the store."""
        self._queue.release(job_id, self._worker)
        self._queue.requeue(job_id, self._size)

    def settle(self, job_id: str) -> None:
        """Release the lease of a job, and requeue it if it has no outcome in the store."""
        outcome = self._store.records.outcome(job_id)
        log.debug("job %s: %s", job_id, outcome.status if outcome else "no outcome")
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
        """Enqueue the next job of the owner of a job that has ended."""
        job = self._store.records.job(job_id)
        if job is not None:
            admit(self._store, self._queue, self._settings, job.owner)

    def _is_open(self, job_id: str) -> bool:
        return not self._store.records.has_ended(job_id)
