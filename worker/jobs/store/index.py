"""The index of jobs by time, newest first: an empty object for each job, so that a list needs no records.

A bucket lists names in ascending order, but the newest jobs are listed first. The names therefore contain the time with
each digit d replaced by 9 - d. Cursors of the API contain the time itself.
"""

import re

from worker.jobs.job import Job
from worker.jobs.objects.interface import ObjectStorage, name_of
from worker.jobs.store.layout import NO_OWNER, TIMELINE, LayoutVersion, entry_name, in_time_folders

CURSOR = r"^[0-9]{8}T[0-9]{12}-[0-9a-f]{32}$"
EARLIER = "index"  # the folder of entries of earlier versions, which are not in folders per minute
_ENTRY = re.compile(CURSOR, re.ASCII)
_COMPLEMENT = str.maketrans("0123456789", "9876543210")


class JobIndex:
    """The entries of all owners' jobs; an entry is written before its job is and removed after it."""

    def __init__(self, objects: ObjectStorage) -> None:
        self._objects = objects
        self._version = LayoutVersion(objects)

    def add(self, job: Job) -> None:
        self._objects.put(timeline_key(job.owner, entry_name(job)), b"", durable=False)

    def remove(self, job: Job) -> None:
        self.remove_entry(job.owner, entry_name(job))

    def remove_entry(self, owner: str | None, entry: str) -> None:
        self._objects.delete(timeline_key(owner, entry))
        if not self._version.is_current():
            self._objects.delete(_earlier_key(owner, entry))

    def page(self, owner: str | None, before: str | None, limit: int) -> list[str]:
        """Return the names of the newest entries that are older than the entry ``before``, newest first."""
        entries = self._entries(TIMELINE, owner, timeline_key(owner, before) if before else "", limit)
        if not self._version.is_current():
            entries |= self._entries(EARLIER, owner, _earlier_key(owner, before) if before else "", limit)
        return sorted(entries, key=complemented)[:limit]

    def _entries(self, folder: str, owner: str | None, after: str, limit: int) -> set[str]:
        keys = self._objects.keys_below(f"{folder}/{owner or NO_OWNER}", after, limit)
        return {complemented(name_of(key)) for key in keys}


def is_entry_name(text: str) -> bool:
    return _ENTRY.fullmatch(text) is not None


def job_id_of(entry: str) -> str:
    return entry[-32:]


def complemented(entry: str) -> str:
    """Return the stored name of an entry, or the entry of a stored name: the function is its own inverse."""
    time, dash, job_id = entry.partition("-")
    return time.translate(_COMPLEMENT) + dash + job_id


def timeline_key(owner: str | None, entry: str) -> str:
    return f"{TIMELINE}/{owner or NO_OWNER}/{in_time_folders(complemented(entry))}"


def _earlier_key(owner: str | None, entry: str) -> str:
    return f"{EARLIER}/{owner or NO_OWNER}/{complemented(entry)}"
