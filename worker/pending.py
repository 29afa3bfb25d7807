"""Which jobs have no outcome yet: an empty object for each, from before the job is accepted until after its end."""

import time

from worker.jobs import Job, is_job_id
from worker.layout import MANIFEST, RECORD, entry_name, job_folder, job_key
from worker.objects import ObjectInfo, ObjectStorage

_FOLDER = "pending"
_GRACE_S = 3600.0  # a marker without a job may be one that is about to come
_BELIEVED_LOOKS = 100.0  # for how many pauses of the store a marker that was checked is not checked again
_ID_ENDS_AT = len("20000101T000000000000-") + 32


class PendingJobs:
    """The markers, checked against the jobs: after a crash between two writes one may be too many."""

    def __init__(self, objects: ObjectStorage) -> None:
        self._objects = objects
        self._listed: tuple[float, list[ObjectInfo]] = (float("-inf"), [])
        self._checked: dict[str, float] = {}  # when a marker was found to be true

    def add(self, job: Job) -> None:
        self._objects.put(_key(job), b"")
        self._listed = (float("-inf"), [])

    def remove(self, job: Job) -> None:
        self._objects.delete(_key(job))
        self._listed = (float("-inf"), [])

    def all(self) -> dict[str, str | None]:
        """The jobs, oldest first, and their owners."""
        markers = self._list()
        self._checked = {marker.key: self._checked.get(marker.key, float("-inf")) for marker in markers}
        return {_job_id(marker): _owner(marker) for marker in self._true(markers)}

    def of(self, owner: str | None) -> list[str]:
        """Those of one owner, oldest first."""
        return [_job_id(marker) for marker in self._true([one for one in self._list() if _owner(one) == owner])]

    def ids(self) -> set[str]:
        """All of them, unchecked: cheap, and now and then one too many."""
        return {_job_id(marker) for marker in self._list()}

    def count(self, owner: str | None) -> tuple[int, int]:
        """How many there are: of everybody, and of one owner; cheap, and now and then one too many."""
        markers = self._list()
        return len(markers), sum(_owner(marker) == owner for marker in markers)

    def oldest_s(self, at_s: float) -> float:
        """The age of the oldest at a time in seconds since 1970; 0 where there is none."""
        return max(0.0, at_s - min((marker.modified_at for marker in self._list()), default=at_s))

    def _list(self) -> list[ObjectInfo]:
        """The markers as of now, or of a moment ago where looking costs something."""
        listed_at, markers = self._listed
        began_at = time.monotonic()
        if began_at - listed_at >= 2 * self._objects.look_s:
            markers = [one for one in self._objects.list_below(_FOLDER) if is_job_id(_job_id(one))]
            self._listed = (began_at, markers)
        return markers

    def _true(self, markers: list[ObjectInfo]) -> list[ObjectInfo]:
        """Those of jobs without an outcome."""
        at_s, checked = time.monotonic(), self._checked
        believed_s = _BELIEVED_LOOKS * self._objects.look_s
        doubtful = [one for one in markers if at_s - checked.get(one.key, float("-inf")) >= believed_s]
        verdicts = dict(zip((one.key for one in doubtful), self._objects.each(self._is_true, doubtful), strict=True))
        checked.update({key: at_s for key, is_true in verdicts.items() if is_true})
        return [one for one in markers if verdicts.get(one.key, True)]

    def _is_true(self, marker: ObjectInfo) -> bool:
        """Whether there is such a job without an outcome; a marker of one that has ended is removed."""
        job_id = _job_id(marker)
        accepted = self._objects.exists(job_key(job_id, RECORD))
        if accepted and not self._objects.exists(job_key(job_id, MANIFEST)):
            return True
        if not accepted and marker.modified_at >= time.time() - _GRACE_S:
            return False
        if not accepted:
            remove_remains(self._objects, job_id)
        self._objects.delete(marker.key)
        return False


def remove_remains(objects: ObjectStorage, job_id: str) -> None:
    """Remove what is left of a job that was never accepted, or was deleted."""
    left = [one.key for one in objects.list_below(job_folder(job_id))]
    if job_key(job_id, RECORD) not in left:
        objects.each(objects.delete, left)


def _key(job: Job) -> str:
    return f"{_FOLDER}/{entry_name(job)}{f'.{job.owner}' if job.owner else ''}"


def _job_id(marker: ObjectInfo) -> str:
    return marker.name[_ID_ENDS_AT - 32 : _ID_ENDS_AT]


def _owner(marker: ObjectInfo) -> str | None:
    return marker.name[_ID_ENDS_AT + 1 :] or None
