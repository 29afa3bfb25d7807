"""Retention: removes jobs above the limits on age and size, a limited number at a time."""

import logging

from cleave.settings import Settings
from worker.janitor.census import Census
from worker.jobs.store.ended import EndedJob
from worker.jobs.store.store import JobStore, UnknownJob

log = logging.getLogger("cleave.janitor")

_REMOVED_AT_ONCE = 50  # jobs, which takes about a second in a folder, so that lost jobs do not wait; set by hand
_GRACE_S = 60.0  # for a client that waits for a job to see its end, beside CLEAVE_MAX_WAIT_S; set by hand


class Retention:
    """Removes the jobs that ended first until the settings keep the rest.

    A job is kept if it has no outcome, if it ended so recently that its client may not have seen the end, or if its
    webhook is not delivered yet.
    """

    def __init__(self, store: JobStore, settings: Settings, census: Census) -> None:
        self._store = store
        self._settings = settings
        self._census = census
        self._passed = ""  # the last key that was passed over

    def step(self, at_s: float) -> bool:
        """Remove some of the jobs that are not kept at a time in seconds since 1970; return whether more may be left.

        The index is read in the order of ends, up to the first job that is kept for its age.
        """
        entries = self._store.ended.oldest(self._passed, _REMOVED_AT_ONCE)
        for entry in entries:
            if not self._is_surplus(entry, at_s):
                self._passed = ""
                return False
            if self._store.outbox.delivery(entry.id) is None:
                self._remove(entry)
            else:
                self._passed = entry.key
        if len(entries) < _REMOVED_AT_ONCE:
            self._passed = ""
            return False
        return True

    def _is_surplus(self, entry: EndedJob, at_s: float) -> bool:
        if entry.ended_at >= at_s - _GRACE_S - self._settings.max_wait_s:
            return False
        is_old = self._settings.retention_s is not None and entry.ended_at < at_s - self._settings.retention_s
        return is_old or self._excess_bytes() > 0

    def _excess_bytes(self) -> int:
        if self._settings.retention_bytes is None or self._census.result is None:
            return 0
        return self._census.result.size_bytes - self._settings.retention_bytes

    def _remove(self, entry: EndedJob) -> None:
        try:
            self._store.delete(entry.id)
            log.info("job %s was removed: it is older, or the store is larger, than the settings allow", entry.id)
        except UnknownJob:  # it was deleted while it ended
            self._store.ended.remove(entry.key)
        self._census.removed(entry)
