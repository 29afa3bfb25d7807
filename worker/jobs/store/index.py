"""The index of jobs by time, newest first: an empty object for each job, so that a list needs no records.

A bucket lists names in ascending order, but the newest jobs are listed first. The names therefore contain the time with
each digit d replaced by 9 - d. Cursors of the API contain the time itself.
"""

import re

from worker.jobs.job import Job
from worker.jobs.objects.interface import ObjectStorage, name_of
from worker.jobs.store.layout import NOBODY, entry_name

CURSOR = r"^[0-9]{8}T[0-9]{12}-[0-9a-f]{32}$"
_FOLDER = "index"
_COMPLEMENT = str.maketrans("0123456789", "9876543210")


class JobIndex:
    """The entries of all owners' jobs; an entry is written before its job is and removed after it."""

    def __init__(self, objects: ObjectStorage) -> None:
        self._objects = objects

    def add(self, job: Job) -> None:
        self._objects.put(_key(job.owner, entry_name(job)), b"")

    def remove(self, job: Job) -> None:
        self.remove_entry(job.owner, entry_name(job))

    def remove_entry(self, owner: str | None, entry: str) -> None:
        self._objects.delete(_key(owner, entry))

    def page(self, owner: str | None, before: str | None, limit: int) -> list[str]:
        """Return the names of the newest entries that are older than the entry ``before``, newest first."""
        after = _key(owner, before) if before else ""
        return [complemented(name_of(key)) for key in self._objects.keys_below(_folder(owner), after, limit)]


def is_entry_name(text: str) -> bool:
    return re.fullmatch(CURSOR, text) is not None


def job_id_of(entry: str) -> str:
    return entry[-32:]


def complemented(entry: str) -> str:
    """Return the stored name of an entry, or the entry of a stored name: the function is its own inverse."""
    time, dash, job_id = entry.partition("-")
    return time.translate(_COMPLEMENT) + dash + job_id


def _folder(owner: str | None) -> str:
    return f"{_FOLDER}/{owner or NOBODY}"


def _key(owner: str | None, entry: str) -> str:
    return f"{_folder(owner)}/{complemented(entry)}"
