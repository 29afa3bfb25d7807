"""Retention: removes jobs above the limits on age and size, and the remains of uploads and deletions."""

import logging
import time
from collections.abc import Iterable
from dataclasses import dataclass

from cleave.settings import Settings
from worker.jobs.objects.interface import ObjectInfo
from worker.jobs.queue.counters import JobCounters, Stored
from worker.jobs.store.layout import JOBS, MANIFEST, RECORD
from worker.jobs.store.store import JobStore, UnknownJob

log = logging.getLogger("cleave.janitor")

_PAUSE_S = 30.0  # between two listings of all objects, in a folder
_LIST_PAUSE_S = 3600.0  # between two listings only for the metrics
_PAUSE_POLLS = 600  # poll intervals of the storage: 300 s in a bucket, in which a listing costs time and money
_GRACE_S = 60.0  # for a client that waits for a job to see its end, beside CLEAVE_MAX_WAIT_S; set by hand
_UPLOAD_UNTOUCHED_S = 3600.0  # far longer than CLEAVE_UPLOAD_IDLE_S (30 s), after which an upload is ended
_DELETION_S = 60.0  # longer than any deletion takes; set by hand
_DELETED_S = 30 * 24 * 3600.0  # for so long the API answers 410 for a deleted job, and 404 afterwards


@dataclass(slots=True)
class StoredJob:
    """The size and age of a stored job."""

    id: str
    size_bytes: int = 0
    ended_at: float | None = None  # seconds since 1970; None if it has no outcome
    is_accepted: bool = False

    def add(self, one: ObjectInfo) -> None:
        self.size_bytes += one.size_bytes
        self.is_accepted |= one.name == RECORD
        if one.name == MANIFEST:
            self.ended_at = one.modified_at


class Housekeeping:
    """Removes what is not kept, at intervals, as that needs a list of all objects."""

    def __init__(self, store: JobStore, settings: Settings, counters: JobCounters) -> None:
        self._store = store
        self._settings = settings
        self._pause_s = max(_PAUSE_S, _PAUSE_POLLS * store.objects.poll_interval_s)
        self._next_at = float("-inf")
        self._next_list_at = float("-inf")
        self._counters = counters

    def sweep_machine(self) -> None:
        """Remove abandoned uploads on this machine, which no other machine can do."""
        self._store.spool.remove_abandoned(_UPLOAD_UNTOUCHED_S)

    def sweep(self, at_s: float) -> None:
        """Remove what the store need not keep, if the interval is over; ``at_s`` is the time on a monotonic clock."""
        if at_s < self._next_at:
            return
        self._next_at = at_s + self._pause_s
        self._store.finish_deletions(_DELETION_S)
        self._store.deletions.forget(_DELETED_S)
        is_limited = self._settings.retention_s is not None or self._settings.retention_bytes is not None
        if is_limited or at_s >= self._next_list_at:
            self._next_list_at = at_s + _LIST_PAUSE_S
            jobs = stored_jobs(self._store)
            self._counters.jobs_listed(Stored(len(jobs), sum(job.size_bytes for job in jobs)))
            remove_surplus(self._store, jobs, self._settings, time.time())


def remove_surplus(store: JobStore, jobs: Iterable[StoredJob], settings: Settings, at_s: float) -> None:
    """Delete those of the stored jobs that the settings do not keep, at a time in seconds since 1970."""
    undelivered = store.outbox.job_ids()
    for job_id in surplus(jobs, undelivered, settings, at_s):
        try:
            store.delete(job_id)
        except UnknownJob:
            continue
        log.info("job %s was removed: it is older, or the store is larger, than the settings allow", job_id)


def stored_jobs(store: JobStore) -> list[StoredJob]:
    """Return the size and age of every stored job."""
    jobs: dict[str, StoredJob] = {}
    for one in store.objects.list_below(JOBS):
        job_id = one.key.split("/")[1]
        jobs.setdefault(job_id, StoredJob(job_id)).add(one)
    return list(jobs.values())


def surplus(jobs: Iterable[StoredJob], undelivered: set[str], settings: Settings, at_s: float) -> list[str]:
    """Return the ids of the jobs to be removed, in the order of their ends.

    A job is kept if it has no outcome, if it ended so recently that its client may not have seen the end, or if its
    webhook is not delivered yet.
    """
    stored = list(jobs)
    seen_by = at_s - _GRACE_S - settings.max_wait_s
    ended = sorted(
        (job.ended_at, job.id, job.size_bytes)
        for job in stored
        if job.is_accepted and job.ended_at is not None and job.ended_at < seen_by and job.id not in undelivered
    )
    oldest = float("-inf") if settings.retention_s is None else at_s - settings.retention_s
    excess_bytes = 0
    if settings.retention_bytes is not None:
        excess_bytes = sum(job.size_bytes for job in stored) - settings.retention_bytes
    surplus_ids = []
    for ended_at, job_id, size_bytes in ended:
        if ended_at < oldest or excess_bytes > 0:
            surplus_ids.append(job_id)
            excess_bytes -= size_bytes
    return surplus_ids
