"""Migration of the names of earlier versions: a few when a store is opened, and most of them by the janitor."""

import json
import os
from collections.abc import Iterable, Iterator
from contextlib import suppress
from datetime import datetime
from itertools import islice
from pathlib import Path

from worker.jobs.job import is_job_id
from worker.jobs.objects.interface import name_of
from worker.jobs.store import deletion, index
from worker.jobs.store.index import complemented, is_entry_name, timeline_key
from worker.jobs.store.layout import JOBS, MANIFEST, NO_OWNER, TIME_FORMAT, LayoutVersion
from worker.jobs.store.store import JobStore

_ID_LENGTH = 32
_THIS_MILLENNIUM = "2"  # the first digit of a time that is not complemented, until the year 3000
_STEP = 5000  # keys of a step, which take some tenths of a second in a folder; set by hand


class Migration:
    """Moves the index entries and memories of earlier versions, in steps between which the store is used as usual.

    Until the last step lists of jobs are read from the earlier index, too. A step that is repeated after a crash
    changes nothing: a new name is durable before the earlier one is removed.
    """

    def __init__(self, store: JobStore) -> None:
        self._store = store
        self._objects = store.objects
        self._version = LayoutVersion(store.objects)
        self._steps = self._all_steps()

    def step(self) -> bool:
        """Migrate some objects; return False if none are left."""
        if self._version.is_current():
            return False
        try:
            next(self._steps, None)
        except OSError:
            self._steps = self._all_steps()
            raise
        return not self._version.is_current()

    def _all_steps(self) -> Iterator[None]:
        works = (
            (index.EARLIER, self._move_entries),
            (JOBS, self._record_ends),
            (deletion.EARLIER, self._move_memories),
            ("computed", self._remove_single_jobs),
        )
        for folder, work in works:
            for keys in _steps(self._objects.walk(folder)):
                work(keys)
                yield
        self._version.make_current()

    def _move_entries(self, keys: list[str]) -> None:
        """Move entries of the list of jobs into folders per minute."""
        self._add([moved for moved in map(_moved, keys) if moved])
        self._objects.each(self._objects.delete, keys)

    def _record_ends(self, keys: list[str]) -> None:
        """Add the jobs that ended in earlier versions to the index of ended jobs."""
        ended = [key.split("/")[1] for key in keys if name_of(key) == MANIFEST]
        self._add([key for key in self._objects.each(self._missing_end, ended) if key])

    def _missing_end(self, job_id: str) -> str | None:
        """Return the key under which an ended job is missing in the index; None if it is not missing."""
        job, outcome = self._store.records.job(job_id), self._store.records.outcome(job_id)
        if job is None or outcome is None:
            return None
        key = self._store.ended.key_of(job, outcome)
        return None if self._objects.exists(key) else key

    def _add(self, keys: list[str]) -> None:
        """Write empty objects, and make all of them durable at once."""
        self._objects.each(lambda key: self._objects.put(key, b"", durable=False), keys)
        self._objects.sync(keys)

    def _move_memories(self, keys: list[str]) -> None:
        for key in keys:
            self._store.deletions.move_memory(key)

    def _remove_single_jobs(self, keys: list[str]) -> None:
        """Remove the entries of a version in which one job stood for all with the same input."""
        for key in keys:
            if key.count("/") == 2:
                self._objects.delete(key)


def _moved(key: str) -> str | None:
    """Return the key of an entry in folders per minute."""
    folder, _, name = key.rpartition("/")
    owner, entry = name_of(folder), complemented(name)
    return timeline_key(None if owner == NO_OWNER else owner, entry) if is_entry_name(entry) else None


def rename_at_once(data_dir: Path) -> None:
    """Rename what must have the names of later versions before the store is used; several processes may do so at once.

    Markers of unfinished jobs had no times once, and the times of the list of jobs were not complemented.
    """
    for folder in _scan(data_dir / index.EARLIER):
        for entry in _scan(Path(folder)):
            if entry.name.startswith(_THIS_MILLENNIUM) and is_entry_name(entry.name):
                _rename(Path(entry), complemented(entry.name))
    for marker in _scan(data_dir / "pending"):
        job_id, owner = marker.name[:_ID_LENGTH], marker.name[_ID_LENGTH:]
        if is_job_id(job_id) and owner[:1] in ("", "."):
            with suppress(FileNotFoundError):
                record = json.loads((data_dir / JOBS / job_id / "job.json").read_bytes())
                accepted_at = datetime.fromisoformat(record["created_at"])
                _rename(Path(marker), f"{accepted_at:{TIME_FORMAT}}-{job_id}{owner}")


def _scan(folder: Path) -> list[os.DirEntry[str]]:
    try:
        return list(os.scandir(folder))
    except (FileNotFoundError, NotADirectoryError):
        return []


def _rename(path: Path, name: str) -> None:
    with suppress(FileNotFoundError):
        path.rename(path.with_name(name))


def _steps(keys: Iterable[str]) -> Iterator[list[str]]:
    iterator = iter(keys)
    while step := list(islice(iterator, _STEP)):
        yield step
