"""Which job has computed what: the same mesh with the same parameters need not be segmented twice.

<data>/computed/<owner>/<fingerprint>   the id of the latest job that set out to compute it
"""

import hashlib
import json
from pathlib import Path

from worker.durable import TEMPORARY_SUFFIX
from worker.jobs import Job, is_job_id

_NOBODY = "_"  # not the name of an owner


class ComputedIndex:
    """A hint, no more: the job may have failed, or be gone."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)

    def note(self, job: Job) -> None:
        path = self._path(job)
        path.parent.mkdir(mode=0o700, exist_ok=True)
        temporary = path.with_name(f".{job.id}{TEMPORARY_SUFFIX}")
        temporary.write_text(job.id)
        temporary.replace(path)  # not synced: a hint may be lost

    def find(self, job: Job) -> str | None:
        """The id of a job of the same owner that was given the same to do."""
        try:
            job_id = self._path(job).read_text()
        except FileNotFoundError:
            return None
        return job_id if is_job_id(job_id) else None

    def remove(self, job: Job) -> None:
        if self.find(job) == job.id:
            self._path(job).unlink(missing_ok=True)

    def _path(self, job: Job) -> Path:
        return self._folder / (job.owner or _NOBODY) / fingerprint(job)


def fingerprint(job: Job) -> str:
    """Equal for jobs whose results are equal bytes."""
    given = [job.sha256, job.mesh_format, job.version, sorted(job.parameters.items())]
    return hashlib.sha256(json.dumps(given).encode()).hexdigest()
