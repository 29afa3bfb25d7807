"""The jobs without an outcome: each has a marker, an empty object, from before its acceptance until after its end."""

import time
from collections.abc import Callable, Sequence
from datetime import UTC, datetime
from typing import NamedTuple

from worker.jobs.job import Job
from worker.jobs.objects.interface import ObjectStorage, name_of
from worker.jobs.store.index import is_entry_name
from worker.jobs.store.layout import MANIFEST, RECORD, TIME_FORMAT, TIME_LENGTH, entry_name, job_folder, job_key

_FOLDER = "pending"
_GRACE_S = 3600.0  # the job of a younger marker may still be uploaded to the store; set by hand
_CHECKED_POLLS = 100.0  # poll intervals, 50 s in a bucket, for which a marker is not checked again; set by hand
_LISTED_POLLS = 2.0  # poll intervals, 1 s in a bucket, for which a list of markers is reused; set by hand
_NEVER = float("-inf")
_ENTRY_LENGTH = TIME_LENGTH + 1 + 32
_NAME_AT = len(_FOLDER) + 1


class Marker(NamedTuple):
    """The marker of a job, by its key; a submission reads all of them, so they are cheap."""

    key: str

    @property
    def job_id(self) -> str:
        return name_of(self.key)[TIME_LENGTH + 1 : _ENTRY_LENGTH]

    @property
    def owner(self) -> str | None:
        return name_of(self.key)[_ENTRY_LENGTH + 1 :] or None

    @property
    def accepted_at(self) -> float:
        time_text = name_of(self.key)[:TIME_LENGTH]
        return datetime.strptime(time_text, TIME_FORMAT).replace(tzinfo=UTC).timestamp()


class PendingJobs:
    """The markers, checked against the jobs, as a crash between two writes can leave a marker too many."""

    def __init__(self, objects: ObjectStorage, record_end: Callable[[str], None]) -> None:
        """``record_end`` is called with the id of a job that has an outcome before its marker is removed."""
        self._objects = objects
        self._record_end = record_end
        self._listed: tuple[float, list[Marker]] = (_NEVER, [])
        self._checked: dict[Marker, float] = {}  # when a marker was found to belong to an unfinished job

    def add(self, job: Job) -> None:
        self._objects.put(marker_key(job), b"", durable=False)
        self._listed = (_NEVER, [])

    def remove(self, job: Job) -> None:
        self._objects.delete(marker_key(job))
        self._listed = (_NEVER, [])

    def markers(self) -> list[Marker]:
        """Return all markers, oldest first, without a check; those of a remote storage may be a second old."""
        listed_at, markers = self._listed
        began_at = time.monotonic()
        if began_at - listed_at >= _LISTED_POLLS * self._objects.poll_interval_s:
            keys = self._objects.keys_below(_FOLDER)
            markers = [Marker(key) for key in keys if is_entry_name(key[_NAME_AT : _NAME_AT + _ENTRY_LENGTH])]
            self._listed = (began_at, markers)
            self._checked = {marker: self._checked[marker] for marker in markers if marker in self._checked}
        return markers

    def unfinished(self, markers: Sequence[Marker]) -> list[Marker]:
        """Return those whose job exists and has no outcome."""
        at_s, checked = time.monotonic(), self._checked
        valid_s = _CHECKED_POLLS * self._objects.poll_interval_s
        unchecked = [marker for marker in markers if at_s - checked.get(marker, _NEVER) >= valid_s]
        results = dict(zip(unchecked, self._objects.each(self._is_unfinished, unchecked), strict=True))
        if valid_s > 0:
            checked.update({marker: at_s for marker, is_unfinished in results.items() if is_unfinished})
        return [marker for marker in markers if results.get(marker, True)]

    def oldest_of(self, owner: str | None, most: int) -> list[str]:
        """Return the oldest unfinished jobs of an owner, oldest first, at most ``most``."""
        owned = [marker for marker in self.markers() if marker.owner == owner]
        found: list[str] = []
        while owned and len(found) < most:
            first, owned = owned[: most - len(found)], owned[most - len(found) :]
            found += [marker.job_id for marker in self.unfinished(first)]
        return found

    def ids(self) -> set[str]:
        """Return all unfinished jobs without a check, so that ended ones may be among them."""
        return {marker.job_id for marker in self.markers()}

    def count(self, owner: str | None) -> tuple[int, int]:
        """Return the number of unfinished jobs of all owners and of one, without a check."""
        markers = self.markers()
        suffix, owner_at = f".{owner}" if owner else "", _NAME_AT + _ENTRY_LENGTH
        return len(markers), sum(marker.key[owner_at:] == suffix for marker in markers)

    def oldest_s(self, at_s: float) -> float:
        """Return the age of the oldest unfinished job at a time in seconds since 1970; 0 if there is none."""
        markers = self.markers()
        return max(0.0, at_s - markers[0].accepted_at) if markers else 0.0

    def _is_unfinished(self, marker: Marker) -> bool:
        """Whether the job of a marker exists and has no outcome; if it has ended, the marker is removed."""
        accepted = self._objects.exists(job_key(marker.job_id, RECORD))
        if accepted and not self._objects.exists(job_key(marker.job_id, MANIFEST)):
            return True
        if not accepted and marker.accepted_at >= time.time() - _GRACE_S:
            return False
        if accepted:
            self._record_end(marker.job_id)
        else:
            remove_remains(self._objects, marker.job_id)
        self._objects.delete(marker.key)
        return False


def remove_remains(objects: ObjectStorage, job_id: str) -> None:
    """Remove the objects of a job that was never accepted or was deleted."""
    left = objects.keys_below(job_folder(job_id))
    if job_key(job_id, RECORD) not in left:
        objects.each(objects.delete, left)


def marker_key(job: Job) -> str:
    return f"{_FOLDER}/{entry_name(job)}{f'.{job.owner}' if job.owner else ''}"
