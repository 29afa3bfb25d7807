"""The search for unfinished jobs that are missing from the queue, a limited number at a time."""

from collections.abc import Iterator
from itertools import islice

from worker.jobs.admission import belonging_in_queue
from worker.jobs.queue.queue import JobQueue
from worker.jobs.store.pending import Marker
from worker.jobs.store.store import JobStore

_SEARCHED_AT_ONCE = 1000  # unfinished jobs; each sweep searches all of them if there are no more; set by hand


class Search:
    """Searches in rounds. A round lists the unfinished and the waiting jobs once and compares them in several sweeps.

    The cost of a sweep therefore does not depend on the number of waiting jobs; how soon a job is found missing does.
    """

    def __init__(self, store: JobStore, queue: JobQueue, most_of_owner: int | None) -> None:
        self._store = store
        self._queue = queue
        self._most_of_owner = most_of_owner
        self.restart()

    def restart(self) -> None:
        """Forget what was found, and begin a round with the next search."""
        self._left: Iterator[Marker] = iter(())
        self._waiting: set[str] = set()
        self._missing: list[Marker] = []

    def next_missing(self) -> list[str]:
        """Return the jobs that are missing among the next ones of the round and those returned before, oldest first."""
        candidates = {marker for marker in self._next() if marker.job_id not in self._waiting}.union(self._missing)
        unfinished = self._store.pending.unfinished(sorted(candidates, key=lambda marker: marker.key))
        held = self._queue.held([marker.job_id for marker in unfinished])
        self._missing = [marker for marker in unfinished if marker.job_id not in held]
        return [marker.job_id for marker in self._missing]

    def _next(self) -> list[Marker]:
        found = list(islice(self._left, _SEARCHED_AT_ONCE))
        if not found:
            self._left = iter(belonging_in_queue(self._store.pending.markers(), self._most_of_owner))
            self._waiting = self._queue.waiting()  # after the markers, so that a new job is not missing
            found = list(islice(self._left, _SEARCHED_AT_ONCE))
        return found
