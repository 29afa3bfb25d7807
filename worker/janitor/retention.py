"""What an installation does not keep: jobs beyond its limits, and what is left of those that came to nothing."""

import logging
import time
from collections.abc import Iterable
from dataclasses import dataclass

from cleave.settings import Settings
from worker.jobs.objects.interface import ObjectInfo
from worker.jobs.store.layout import JOBS, MANIFEST, RECORD
from worker.jobs.store.store import JobStore, UnknownJob

log = logging.getLogger("cleave.janitor")

_PAUSE_S = 30.0  # between two listings of all objects, in a folder
_PAUSE_POLLS = 600  # poll intervals of the storage: 300 s in a bucket, in which a listing costs time and money
_GRACE_S = 60.0  # in which a client that waits for a job sees its end, beside the longest wait
_UPLOAD_UNTOUCHED_S = 3600.0
_DELETION_S = 60.0  # no deletion takes so long
_DELETED_S = 30 * 24 * 3600.0  # for so long clients are told that a job was there


@dataclass(slots=True)
class StoredJob:
    """What a job takes up."""

    id: str
    size_bytes: int = 0
    ended_at: float | None = None  # seconds since 1970; None: it has no outcome
    is_accepted: bool = False

    def add(self, one: ObjectInfo) -> None:
        self.size_bytes += one.size_bytes
        self.is_accepted |= one.name == RECORD
        if one.name == MANIFEST:
            self.ended_at = one.modified_at


class Housekeeping:
    """Now and then a look at everything; in between nothing."""

    def __init__(self, store: JobStore, settings: Settings) -> None:
        self._store = store
        self._settings = settings
        self._pause_s = max(_PAUSE_S, _PAUSE_POLLS * store.objects.poll_interval_s)
        self._next_at = float("-inf")

    def sweep_machine(self) -> None:
        """Tidy up on this machine, which nobody else does."""
        self._store.spool.remove_abandoned(_UPLOAD_UNTOUCHED_S)

    def sweep(self, at_s: float) -> None:
        """Tidy up in the store, unless that was done lately; ``at_s`` is the time on a clock that only goes forward."""
        if at_s < self._next_at:
            return
        self._next_at = at_s + self._pause_s
        self._store.finish_deletions(_DELETION_S)
        self._store.deletions.forget(_DELETED_S)
        remove_surplus(self._store, self._settings, time.time())


def remove_surplus(store: JobStore, settings: Settings, at_s: float) -> None:
    """Delete the jobs that the settings do not keep at a time in seconds since 1970."""
    if settings.retention_s is None and settings.retention_bytes is None:
        return
    untold = store.outbox.job_ids()
    for job_id in surplus(stored_jobs(store), untold, settings, at_s):
        try:
            store.delete(job_id)
        except UnknownJob:
            continue
        log.info("job %s was removed: it is older, or the store is larger, than the settings allow", job_id)


def stored_jobs(store: JobStore) -> list[StoredJob]:
    """What is stored of every job."""
    jobs: dict[str, StoredJob] = {}
    for one in store.objects.list_below(JOBS):
        job_id = one.key.split("/")[1]
        jobs.setdefault(job_id, StoredJob(job_id)).add(one)
    return list(jobs.values())


def surplus(jobs: Iterable[StoredJob], untold: set[str], settings: Settings, at_s: float) -> list[str]:
    """The ids of the jobs that go, those that ended first before the others.

    Nobody loses what they could not have seen: a job stays that has no outcome, that ended a moment ago, or of which a
    webhook is still to be told.
    """
    stored = list(jobs)
    seen_by = at_s - _GRACE_S - settings.max_wait_s
    ended = sorted(
        (job.ended_at, job.id, job.size_bytes)
        for job in stored
        if job.is_accepted and job.ended_at is not None and job.ended_at < seen_by and job.id not in untold
    )
    oldest = float("-inf") if settings.retention_s is None else at_s - settings.retention_s
    excess_bytes = 0
    if settings.retention_bytes is not None:
        excess_bytes = sum(job.size_bytes for job in stored) - settings.retention_bytes
    doomed = []
    for ended_at, job_id, size_bytes in ended:
        if ended_at < oldest or excess_bytes > 0:
            doomed.append(job_id)
            excess_bytes -= size_bytes
    return doomed
