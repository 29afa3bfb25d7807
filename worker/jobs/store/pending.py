"""The jobs without an outcome: each has a marker, an empty object, from before its acceptance until after its end."""

import time
from datetime import UTC, datetime

from worker.jobs.job import Job
from worker.jobs.objects.interface import ObjectStorage, name_of
from worker.jobs.store.index import is_entry_name
from worker.jobs.store.layout import MANIFEST, RECORD, TIME_FORMAT, entry_name, job_folder, job_key

_FOLDER = "pending"
_GRACE_S = 3600.0  # the job of a younger marker may still be uploaded to the store; set by hand
_CHECKED_POLLS = 100.0  # poll intervals, 50 s in a bucket, for which a marker is not checked again; set by hand
_LISTED_POLLS = 2.0  # poll intervals, 1 s in a bucket, for which a list of markers is reused; set by hand
_NEVER = float("-inf")
_TIME_LENGTH, _ENTRY_LENGTH = 21, 21 + 1 + 32


class PendingJobs:
    """The markers, checked against the jobs, as a crash between two writes can leave a marker too many."""

    def __init__(self, objects: ObjectStorage) -> None:
        self._objects = objects
        self._listed: tuple[float, list[str]] = (_NEVER, [])
        self._checked: dict[str, float] = {}  # when a marker was found to belong to an unfinished job

    def add(self, job: Job) -> None:
        self._objects.put(_key(job), b"")
        self._listed = (_NEVER, [])

    def remove(self, job: Job) -> None:
        self._objects.delete(_key(job))
        self._listed = (_NEVER, [])

    def all(self) -> dict[str, str | None]:
        """Return the unfinished jobs and their owners, oldest first."""
        markers = self._markers()
        self._checked = {marker: self._checked.get(marker, _NEVER) for marker in markers}
        return {_job_id(marker): _owner(marker) for marker in self._unfinished(markers)}

    def of(self, owner: str | None) -> list[str]:
        """Return the unfinished jobs of an owner, oldest first."""
        return [
            _job_id(marker) for marker in self._unfinished([one for one in self._markers() if _owner(one) == owner])
        ]

    def ids(self) -> set[str]:
        """Return all unfinished jobs without a check, so that ended ones may be among them."""
        return {_job_id(marker) for marker in self._markers()}

    def count(self, owner: str | None) -> tuple[int, int]:
        """Return the number of unfinished jobs of all owners and of one, without a check."""
        markers = self._markers()
        return len(markers), sum(_owner(marker) == owner for marker in markers)

    def oldest_s(self, at_s: float) -> float:
        """Return the age of the oldest unfinished job at a time in seconds since 1970; 0 if there is none."""
        markers = self._markers()
        return max(0.0, at_s - _accepted_at(markers[0])) if markers else 0.0

    def _markers(self) -> list[str]:
        """Return the keys, oldest first; those of a remote storage may be a second old."""
        listed_at, markers = self._listed
        began_at = time.monotonic()
        if began_at - listed_at >= _LISTED_POLLS * self._objects.poll_interval_s:
            markers = [key for key in self._objects.keys_below(_FOLDER) if is_entry_name(name_of(key)[:_ENTRY_LENGTH])]
            self._listed = (began_at, markers)
        return markers

    def _unfinished(self, markers: list[str]) -> list[str]:
        """Return those whose job exists and has no outcome."""
        at_s, checked = time.monotonic(), self._checked
        valid_s = _CHECKED_POLLS * self._objects.poll_interval_s
        doubtful = [marker for marker in markers if at_s - checked.get(marker, _NEVER) >= valid_s]
        verdicts = dict(zip(doubtful, self._objects.each(self._is_unfinished, doubtful), strict=True))
        checked.update({marker: at_s for marker, is_unfinished in verdicts.items() if is_unfinished})
        return [marker for marker in markers if verdicts.get(marker, True)]

    def _is_unfinished(self, marker: str) -> bool:
        """Whether the job of a marker exists and has no outcome; if it has ended, the marker is removed."""
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
    """Remove the objects of a job that was never accepted or was deleted."""
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
