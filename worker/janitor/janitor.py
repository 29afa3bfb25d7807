"""The janitor process: it compares the store with the queue and enqueues jobs that the queue has lost."""

import logging
import os
import socket
import time
from collections.abc import Iterable

from cleave.logs import about, configure_logging
from cleave.settings import Settings, load_settings
from worker.janitor.housekeeping import Housekeeping
from worker.janitor.search import Search
from worker.jobs.attempts import exhausted
from worker.jobs.job import Job
from worker.jobs.queue.connection import QueueError, connect
from worker.jobs.queue.counters import JobCounters
from worker.jobs.queue.locks import Locks
from worker.jobs.queue.queue import JobQueue
from worker.jobs.queue.workers import forget_dead_workers
from worker.jobs.size_class import size_class
from worker.jobs.store.opening import open_store
from worker.jobs.store.store import JobStore, UnknownJob

log = logging.getLogger("cleave.janitor")

# A job is missing from the queue for a moment between its acceptance and its entry, and between its entry and lease.
# After Redis has lost its data, a running job has no lease for a second or two. A job that is missing longer is lost.
MISSING_S = 5.0
_LEADER_INTERVALS = 3  # sweeps that a leader may miss before another janitor takes over; set by hand


class _Absences:
    """Since when jobs or edits have been missing from the queue."""

    def __init__(self) -> None:
        self._since: dict[str, float] = {}

    def lost(self, missing: Iterable[str], at_s: float) -> list[str]:
        """Return those of the ids missing at this time that have been missing for so long that they are lost."""
        self._since = {one: self._since.get(one, at_s) for one in missing}
        return [one for one, since in self._since.items() if at_s - since >= MISSING_S]

    def clear(self) -> None:
        self._since.clear()


class Janitor:
    """Compares store and queue at every sweep; in between it only keeps the time since which each job is missing."""

    def __init__(self, store: JobStore, queue: JobQueue, settings: Settings) -> None:
        self._store = store
        self._queue = queue
        self._locks = Locks(queue.connection)
        self._counters = JobCounters(queue.connection)
        self._settings = settings
        self._housekeeping = Housekeeping(store, settings, self._counters)
        # The process id of the supervisor, so that a restarted janitor is the leader at once.
        self._name = f"{socket.gethostname()}.{os.getppid()}"
        self._search = Search(store, queue, settings.key_max_running_jobs)
        self._missing_jobs = _Absences()
        self._missing_edits = _Absences()

    def sweep(self, at_s: float) -> None:
        """Enqueue every unfinished job that neither waits nor runs, or fail it if it has had all its attempts.

        ``at_s`` is the time in seconds on a monotonic clock.
        """
        self._housekeeping.sweep_machine()
        if not self._locks.lead(self._name, _LEADER_INTERVALS * self._settings.janitor_interval_s):
            self._forget_missing()
            return
        lost = self._missing_jobs.lost(self._search.next_missing(), at_s)
        for job_id in reversed(lost):  # each is put at the front, the oldest last
            job = self._store.records.job(job_id)
            if job is not None:
                with about(job_id, job.traceparent):
                    self._recover(job)
        self._recover_edits(at_s)
        forget_dead_workers(self._queue)
        self._housekeeping.sweep(at_s)

    def sweep_failed(self, error: Exception) -> None:
        """Count an error of the store, and forget which jobs are missing, as the queue or the store was not read."""
        if isinstance(error, OSError):
            self._counters.store_failed("janitor")
        self._forget_missing()

    def _forget_missing(self) -> None:
        self._search.restart()
        self._missing_jobs.clear()
        self._missing_edits.clear()

    def _recover_edits(self, at_s: float) -> None:
        """Enqueue the edits that the queue has lost."""
        waiting = self._store.queued_edits.waiting_ids()
        held = self._queue.held(waiting)
        for edit_id in self._missing_edits.lost((edit_id for edit_id in waiting if edit_id not in held), at_s):
            edit = self._store.queued_edits.waiting(edit_id)
            job = None if edit is None else self._store.records.job(edit.job_id)
            if job is not None:
                log.warning("edit %s was lost by the queue and waits again", edit_id)
                self._queue.requeue(edit_id, size_class(job, self._settings.large_job_bytes))

    def _recover(self, job: Job) -> None:
        failed = exhausted(self._store.records.attempts(job.id), self._settings.max_attempts)
        if failed is None:
            log.warning("job %s was lost by the queue and waits again", job.id)
            self._counters.job_recovered()
            self._queue.requeue(job.id, size_class(job, self._settings.large_job_bytes), at_front=True)
            return
        log.error("job %s failed: %s", job.id, failed.code)
        try:
            self._store.finish(job.id, failed)
        except UnknownJob:
            return
        self._counters.job_given_up(failed.code)
        self._queue.forget(job.id)


def main() -> None:
    settings = load_settings()
    configure_logging(settings.log_level, settings.log_format, "janitor")
    assert settings.redis_url, "the parent process sets CLEAVE_REDIS_URL"
    queue = JobQueue(connect(settings.redis_url))
    janitor = Janitor(open_store(settings), queue, settings)
    last_error = ""
    while True:
        last_error = sweep_or_log(janitor, last_error)
        time.sleep(settings.janitor_interval_s)


def sweep_or_log(janitor: Janitor, last_error: str) -> str:
    """Sweep once; an error is logged if it differs from that of the last sweep, and returned."""
    try:
        janitor.sweep(time.monotonic())
    except (QueueError, OSError) as error:
        janitor.sweep_failed(error)
        if str(error) != last_error:
            log.warning("lost jobs cannot be searched for at the moment: %s", error)
        return str(error)
    if last_error:
        log.warning("lost jobs are searched for again")
    return ""
