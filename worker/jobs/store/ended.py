"""The index of ended jobs, oldest end first: an empty object for each, with its size in the name, for retention."""

import re
from dataclasses import dataclass
from datetime import UTC, datetime

from worker.jobs.job import Job, Outcome, Succeeded
from worker.jobs.objects.interface import ObjectStorage, name_of
from worker.jobs.store.layout import ENDED, RESULT, TIME_FORMAT, in_time_folders, job_folder

_NAME = re.compile(r"([0-9]{8}T[0-9]{12})-([0-9a-f]{32})-([0-9]+)", re.ASCII)


@dataclass(frozen=True, slots=True)
class EndedJob:
    """An entry of the index."""

    key: str
    id: str
    ended_at: float  # seconds since 1970
    size_bytes: int  # of its mesh and its result


class EndedIndex:
    """An entry is written after the outcome of its job and removed after the record."""

    def __init__(self, objects: ObjectStorage) -> None:
        self._objects = objects

    def key_of(self, job: Job, outcome: Outcome) -> str:
        """Return the key of the entry of a job, whose result must still exist."""
        size_bytes = job.size_bytes + (self._result_bytes(job.id) if isinstance(outcome, Succeeded) else 0)
        return ended_key(job.id, outcome, size_bytes)

    def add(self, key: str) -> None:
        self._objects.put(key, b"")

    def remove(self, key: str) -> None:
        self._objects.delete(key)

    def oldest(self, after: str, limit: int) -> list[EndedJob]:
        """Return the jobs that ended first, at most ``limit``, of those whose keys follow ``after``."""
        found = ((key, _NAME.fullmatch(name_of(key))) for key in self._objects.keys_below(ENDED, after, limit))
        return [EndedJob(key, name[2], _seconds(name[1]), int(name[3])) for key, name in found if name]

    def _result_bytes(self, job_id: str) -> int:
        return sum(one.size_bytes for one in self._objects.list_below(job_folder(job_id)) if one.name == RESULT)


def ended_key(job_id: str, outcome: Outcome, size_bytes: int) -> str:
    return f"{ENDED}/{in_time_folders(f'{outcome.finished_at:{TIME_FORMAT}}-{job_id}-{size_bytes}')}"


def _seconds(time: str) -> float:
    return datetime.strptime(time, TIME_FORMAT).replace(tzinfo=UTC).timestamp()
