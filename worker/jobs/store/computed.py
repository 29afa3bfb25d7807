"""Which job has computed what: the same mesh with the same parameters need not be segmented twice."""

import hashlib
import json

from worker.jobs.job import Job, is_job_id
from worker.jobs.objects.interface import ObjectStorage
from worker.jobs.store.layout import NOBODY


class ComputedIndex:
    """A hint, no more: the job may have failed, or be gone."""

    def __init__(self, objects: ObjectStorage) -> None:
        self._objects = objects

    def note(self, job: Job) -> None:
        self._objects.put(_key(job), job.id.encode(), durable=False)  # a hint may be lost

    def find(self, job: Job) -> str | None:
        """The id of a job of the same owner that was given the same to do."""
        job_id = (self._objects.get(_key(job)) or b"").decode()
        return job_id if is_job_id(job_id) else None

    def remove(self, job: Job) -> None:
        if self.find(job) == job.id:
            self._objects.delete(_key(job))


def fingerprint(job: Job) -> str:
    """Equal for jobs whose results are equal bytes."""
    given = [job.sha256, job.mesh_format, job.version, sorted(job.parameters.items())]
    return hashlib.sha256(json.dumps(given).encode()).hexdigest()


def _key(job: Job) -> str:
    return f"computed/{job.owner or NOBODY}/{fingerprint(job)}"
