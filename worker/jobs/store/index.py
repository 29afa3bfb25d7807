"""Which jobs there are, newest first, without a look into any of them: an empty object for each, named by its time.

A bucket lists names in ascending order, and the newest jobs are asked for first. So the names have the digits of the
time turned around, 0 for 9 and 9 for 0; what others see of them, as cursors, is the time itself.
"""

import re

from worker.jobs.job import Job
from worker.jobs.objects.interface import ObjectStorage, name_of
from worker.jobs.store.layout import NOBODY, entry_name

CURSOR = r"^[0-9]{8}T[0-9]{12}-[0-9a-f]{32}$"
_FOLDER = "index"
_TURNED = str.maketrans("0123456789", "9876543210")


class JobIndex:
    """The entries of every owner's jobs; an entry may be there a moment before its job and after it."""

    def __init__(self, objects: ObjectStorage) -> None:
        self._objects = objects

    def add(self, job: Job) -> None:
        self._objects.put(_key(job.owner, entry_name(job)), b"")

    def remove(self, job: Job) -> None:
        self.remove_entry(job.owner, entry_name(job))

    def remove_entry(self, owner: str | None, entry: str) -> None:
        self._objects.delete(_key(owner, entry))

    def page(self, owner: str | None, before: str | None, limit: int) -> list[str]:
        """The names of the newest entries that are older than the entry ``before``, newest first."""
        after = _key(owner, before) if before else ""
        return [turned(name_of(key)) for key in self._objects.keys_below(_folder(owner), after, limit)]


def is_entry_name(text: str) -> bool:
    return re.fullmatch(CURSOR, text) is not None


def job_id_of(entry: str) -> str:
    return entry[-32:]


def turned(entry: str) -> str:
    """The name under which an entry is stored, and the other way round."""
    time, dash, job_id = entry.partition("-")
    return time.translate(_TURNED) + dash + job_id


def _folder(owner: str | None) -> str:
    return f"{_FOLDER}/{owner or NOBODY}"


def _key(owner: str | None, entry: str) -> str:
    return f"{_folder(owner)}/{turned(entry)}"
