"""Index of jobs by their input, so that the same mesh with the same parameters is segmented once."""

import hashlib
import json

from worker.jobs.job import Job, is_job_id
from worker.jobs.objects.interface import ObjectStorage
from worker.jobs.store.layout import NO_OWNER


class ComputedIndex:
    """Finds an earlier job with the same input; that job may have failed or been deleted."""

    def __init__(self, objects: ObjectStorage) -> None:
        self._objects = objects

    def add(self, job: Job) -> None:
        self._objects.put(_key(job), job.id.encode(), durable=False)  # a lost entry costs only time

    def find(self, job: Job) -> str | None:
        """Return the id of a job of the same owner with the same input."""
        job_id = (self._objects.get(_key(job)) or b"").decode()
        return job_id if is_job_id(job_id) else None

    def remove(self, job: Job) -> None:
        if self.find(job) == job.id:
            self._objects.delete(_key(job))


def fingerprint(job: Job) -> str:
    """Return a hash that is equal for jobs whose results are equal to the byte."""
    given = [job.sha256, job.mesh_format, job.unit, job.up, job.version, sorted(job.parameters.items())]
    return hashlib.sha256(json.dumps(given).encode()).hexdigest()


def _key(job: Job) -> str:
    return f"computed/{job.owner or NO_OWNER}/{fingerprint(job)}"
