"""Which jobs have no outcome yet: an empty file for each, made before the job is accepted and removed after its end.

<data>/pending/<id>[.<owner>]
"""

import os
import time
from pathlib import Path

from worker.durable import sync_folder
from worker.jobs import Job, is_job_id

_GRACE_S = 3600.0  # a marker without a job may be one that is about to come
_ID_LENGTH = 32


class PendingJobs:
    """The markers, checked against the folders of the jobs: after a crash between two writes one may be too many."""

    def __init__(self, folder: Path, jobs: Path) -> None:
        self._folder = folder
        self._jobs = jobs
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)

    def add(self, job: Job) -> None:
        self._marker(job).touch()
        sync_folder(self._folder)

    def remove(self, job: Job) -> None:
        self._marker(job).unlink(missing_ok=True)

    def all(self) -> dict[str, str | None]:
        """The jobs, oldest first, and their owners."""
        markers = sorted(os.scandir(self._folder), key=_modified_at)
        return {_job_id(marker): _owner(marker) for marker in markers if self._is_true(marker)}

    def of(self, owner: str | None) -> list[str]:
        """Those of one owner, oldest first."""
        markers = [marker for marker in os.scandir(self._folder) if _owner(marker) == owner]
        return [_job_id(marker) for marker in sorted(markers, key=_modified_at) if self._is_true(marker)]

    def count(self, owner: str | None) -> tuple[int, int]:
        """How many there are: of everybody, and of one owner; cheap, and now and then one too many."""
        markers = list(os.scandir(self._folder))
        return len(markers), sum(_owner(marker) == owner for marker in markers)

    def oldest_s(self, at_s: float) -> float:
        """The age of the oldest at a time in seconds since 1970; 0 where there is none."""
        return max(0.0, at_s - min((_modified_at(marker) for marker in os.scandir(self._folder)), default=at_s))

    def _marker(self, job: Job) -> Path:
        return self._folder / (f"{job.id}.{job.owner}" if job.owner else job.id)

    def _is_true(self, marker: os.DirEntry[str]) -> bool:
        """Whether there is such a job without an outcome; a marker of one that has ended is removed."""
        if not is_job_id(_job_id(marker)):
            return False
        folder = self._jobs / _job_id(marker)
        accepted = (folder / "job.json").exists()
        if accepted and not (folder / "manifest.json").exists():
            return True
        if accepted or _modified_at(marker) < time.time() - _GRACE_S:
            Path(marker).unlink(missing_ok=True)
        return False


def _job_id(marker: os.DirEntry[str]) -> str:
    return marker.name[:_ID_LENGTH]


def _owner(marker: os.DirEntry[str]) -> str | None:
    return marker.name[_ID_LENGTH + 1 :] or None


def _modified_at(marker: os.DirEntry[str]) -> float:
    try:
        return marker.stat().st_mtime
    except FileNotFoundError:
        return 0.0
