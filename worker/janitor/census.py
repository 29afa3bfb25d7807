"""The census: the number and the size of the ended jobs, counted in steps."""

from worker.jobs.queue.counters import Stored
from worker.jobs.store.ended import EndedIndex, EndedJob


class Census:
    """Counts the entries of the index again and again; its memory does not depend on their number.

    The result is that of the last complete count, without the jobs that have been removed by this process since. It
    does not know the jobs that ended or were deleted during that count and after it.
    """

    def __init__(self, ended: EndedIndex, counted_at_once: int) -> None:
        self._ended = ended
        self._counted_at_once = counted_at_once
        self._counted_to = ""
        self._counting = Stored(0, 0)
        self.result: Stored | None = None  # None before the first count is complete

    def step(self) -> bool:
        """Count some entries; return whether a count is complete now."""
        entries = self._ended.oldest(self._counted_to, self._counted_at_once)
        counted = Stored(len(entries), sum(entry.size_bytes for entry in entries))
        self._counting = _sum(self._counting, counted)
        if len(entries) == self._counted_at_once:
            self._counted_to = entries[-1].key
            return False
        self.result, self._counting, self._counted_to = self._counting, Stored(0, 0), ""
        return True

    def removed(self, entry: EndedJob) -> None:
        """Note that this process has removed a job."""
        gone = Stored(-1, -entry.size_bytes)
        self.result = self.result and _sum(self.result, gone)
        if entry.key <= self._counted_to:
            self._counting = _sum(self._counting, gone)


def _sum(first: Stored, second: Stored) -> Stored:
    return Stored(first.jobs + second.jobs, first.size_bytes + second.size_bytes)
