"""Which jobs have no outcome yet: an empty object for each, from before the job is accepted until after its end."""

import time
from datetime import UTC, datetime

from worker.jobs.job import Job
from worker.jobs.objects.interface import ObjectStorage, name_of
from worker.jobs.store.index import is_entry_name
from worker.jobs.store.layout import MANIFEST, RECORD, TIME_FORMAT, entry_name, job_folder, job_key

_FOLDER = "pending"
_GRACE_S = 3600.0  # a marker without a job may be one that is about to come
_BELIEVED_LOOKS = 100.0  # for how many pauses of the store a marker that was checked is not checked again
_NEVER = float("-inf")
_TIME_LENGTH, _ENTRY_LENGTH = 21, 21 + 1 + 32


class PendingJobs:
    """The markers, checked against the jobs: after a crash between two writes one may be too many."""

    def __init__(self, objects: ObjectStorage) -> None:
        self._objects = objects
        self._listed: tuple[float, list[str]] = (_NEVER, [])
        self._checked: dict[str, float] = {}  # when a marker was found to be true

    def add(self, job: Job) -> None:
        self._objects.put(_key(job), b"")
        self._listed = (_NEVER, [])

    def remove(self, job: Job) -> None:
        self._objects.delete(_key(job))
        self._listed = (_NEVER, [])

    def all(self) -> dict[str, str | None]:
        """The jobs, oldest first, and their owners."""
        markers = self._markers()
        self._checked = {marker: self._checked.get(marker, _NEVER) for marker in markers}
        return {_job_id(marker): _owner(marker) for marker in self._true(markers)}

    def of(self, owner: str | None) -> list[str]:
        """Those of one owner, oldest first."""
        return [_job_id(marker) for marker in self._true([one for one in self._markers() if _owner(one) == owner])]

    def ids(self) -> set[str]:
        """All of them, unchecked: cheap, and now and then one too many."""
        return {_job_id(marker) for marker in self._markers()}

    def count(self, owner: str | None) -> tuple[int, int]:
        """How many there are: of everybody, and of one owner; cheap, and now and then one too many."""
        markers = self._markers()
        return len(markers), sum(_owner(marker) == owner for marker in markers)

    def oldest_s(self, at_s: float) -> float:
        """The age of the oldest at a time in seconds since 1970; 0 where there is none."""
        markers = self._markers()
        return max(0.0, at_s - _accepted_at(markers[0])) if markers else 0.0

    def _markers(self) -> list[str]:
        """The keys, oldest first, as of now, or of a moment ago where looking costs something."""
        listed_at, markers = self._listed
        began_at = time.monotonic()
        if began_at - listed_at >= 2 * self._objects.poll_interval_s:
            markers = [key for key in self._objects.keys_below(_FOLDER) if is_entry_name(name_of(key)[:_ENTRY_LENGTH])]
            self._listed = (began_at, markers)
        return markers

    def _true(self, markers: list[str]) -> list[str]:
        """Those of jobs without an outcome."""
        at_s, checked = time.monotonic(), self._checked
        believed_s = _BELIEVED_LOOKS * self._objects.poll_interval_s
        doubtful = [marker for marker in markers if at_s - checked.get(marker, _NEVER) >= believed_s]
        verdicts = dict(zip(doubtful, self._objects.each(self._is_true, doubtful), strict=True))
        checked.update({marker: at_s for marker, is_true in verdicts.items() if is_true})
        return [marker for marker in markers if verdicts.get(marker, True)]

    def _is_true(self, marker: str) -> bool:
        """Whether there is such a job without an outcome; a marker of one that has ended is removed."""
        job_id = _job_id(marker)
        accepted = self._objects.exists(job_key(job_id, RECORD))
        if accepted and not self._objects.exists(job_key(job_id, MANIFEST)):
            return True
        if not accepted and _accepted_at(marker) >= time.time() - _GRACE_S:
            return False
        if not accepted:
            remove_remains(self._objects, job_id)
        self._objects.delete(marker)
        return False


def remove_remains(objects: ObjectStorage, job_id: str) -> None:
    """Remove what is left of a job that was never accepted, or was deleted."""
    left = objects.keys_below(job_folder(job_id))
    if job_key(job_id, RECORD) not in left:
        objects.each(objects.delete, left)


def _key(job: Job) -> str:
    return f"{_FOLDER}/{entry_name(job)}{f'.{job.owner}' if job.owner else ''}"


def _accepted_at(marker: str) -> float:
    return datetime.strptime(name_of(marker)[:_TIME_LENGTH], TIME_FORMAT).replace(tzinfo=UTC).timestamp()


def _job_id(marker: str) -> str:
    return name_of(marker)[_TIME_LENGTH + 1 : _ENTRY_LENGTH]


def _owner(marker: str) -> str | None:
    return name_of(marker)[_ENTRY_LENGTH + 1 :] or None
