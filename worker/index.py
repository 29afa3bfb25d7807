"""Which jobs there are, newest first, without a look into any of them: an empty file for each, named by its time.

<data>/index/<owner>/<time>-<id>   an owner of None is the folder "_"
"""

import heapq
import os
import re
from pathlib import Path

from worker.durable import sync_folder
from worker.jobs import Job

CURSOR = r"^[0-9]{8}T[0-9]{12}-[0-9a-f]{32}$"
_NOBODY = "_"  # not the name of an owner


class JobIndex:
    """The entries of every owner's jobs; an entry may be there a moment before its job and after it."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)

    def add(self, job: Job) -> None:
        folder = self._of(job.owner)
        folder.mkdir(mode=0o700, exist_ok=True)
        (folder / entry_name(job)).touch()
        sync_folder(folder)

    def remove(self, job: Job) -> None:
        (self._of(job.owner) / entry_name(job)).unlink(missing_ok=True)

    def page(self, owner: str | None, before: str | None, limit: int) -> list[str]:
        """The names of the newest entries that are older than the entry ``before``, newest first."""
        try:
            names = os.listdir(self._of(owner))
        except FileNotFoundError:
            return []
        return heapq.nlargest(limit, (name for name in names if before is None or name < before))

    def _of(self, owner: str | None) -> Path:
        return self._folder / (owner or _NOBODY)


def entry_name(job: Job) -> str:
    return f"{job.created_at:%Y%m%dT%H%M%S%f}-{job.id}"


def is_entry_name(text: str) -> bool:
    return re.fullmatch(CURSOR, text) is not None


def job_id_of(entry: str) -> str:
    return entry[-32:]
