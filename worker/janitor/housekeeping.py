"""Housekeeping: when the janitor removes what is not kept, counts the jobs and migrates names of earlier versions."""

import time

from cleave.settings import Settings
from worker.janitor.census import Census
from worker.janitor.retention import Retention
from worker.jobs.queue.counters import JobCounters
from worker.jobs.store.migration import Migration
from worker.jobs.store.store import JobStore

_PAUSE_S = 30.0  # between two rounds, in a folder
_COUNTED, _COUNTED_FOR_LIMIT = 250, 2500  # entries in a sweep, 10 us each; a limit needs a recent count; set by hand
_COUNT_PAUSE_S = 3600.0  # between two counts only for the metrics
_PAUSE_POLLS = 600  # poll intervals of the storage: 300 s in a bucket, in which a listing costs time and money
_UPLOAD_UNTOUCHED_S = 3600.0  # far longer than CLEAVE_UPLOAD_IDLE_S (30 s), after which an upload is ended
_DELETION_S = 60.0  # longer than any deletion takes; set by hand
_DELETED_S = 30 * 24 * 3600.0  # for so long the API answers 410 for a deleted job, and 404 afterwards


class Housekeeping:
    """Works in rounds with pauses; a sweep does a limited part of a round, whatever the number of stored jobs.

    Each kind of work returns the seconds until it goes on.
    """

    def __init__(self, store: JobStore, settings: Settings, counters: JobCounters) -> None:
        self._store = store
        self._counters = counters
        self._needs_size = settings.retention_bytes is not None
        self._census = Census(store.ended, _COUNTED_FOR_LIMIT if self._needs_size else _COUNTED)
        self._retention = Retention(store, settings, self._census)
        self._migration = Migration(store)
        self._pause_s = max(_PAUSE_S, _PAUSE_POLLS * store.objects.poll_interval_s)
        self._next_at = dict.fromkeys((self._migrate, self._count, self._remove), float("-inf"))

    def sweep_machine(self) -> None:
        """Remove abandoned uploads on this machine, which no other machine can do."""
        self._store.spool.remove_abandoned(_UPLOAD_UNTOUCHED_S)

    def sweep(self, at_s: float) -> None:
        """Do the next part of each kind of work whose pause is over; ``at_s`` is the time on a monotonic clock."""
        for work, next_at in self._next_at.items():
            if at_s >= next_at:
                self._next_at[work] = at_s + self._pause_s  # also if it fails, so that lost jobs are found meanwhile
                self._next_at[work] = at_s + work()

    def _migrate(self) -> float:
        return 0.0 if self._migration.step() else self._pause_s

    def _count(self) -> float:
        """Count some jobs; after a complete count the next one begins when it is needed."""
        if not self._census.step() or self._census.result is None:
            return 0.0
        self._counters.jobs_counted(self._census.result)
        return self._pause_s if self._needs_size else _COUNT_PAUSE_S

    def _remove(self) -> float:
        self._store.finish_deletions(_DELETION_S)
        self._store.deletions.forget(_DELETED_S)
        return 0.0 if self._retention.step(time.time()) else self._pause_s
