"""Index of jobs by their input, so that the same mesh with the same parameters is segmented once."""

import hashlib
import json
from collections.abc import Iterator

from worker.jobs.job import Job, is_job_id
from worker.jobs.objects.interface import ObjectStorage, name_of
from worker.jobs.store.layout import NO_OWNER


class ComputedIndex:
    """Finds the jobs that have succeeded with an input; one of them may have been deleted meanwhile."""

    def __init__(self, objects: ObjectStorage) -> None:
        self._objects = objects

    def add(self, job: Job) -> None:
        self._objects.put(computed_key(job), b"", durable=False)  # a lost entry costs only time

    def equal_to(self, job: Job) -> Iterator[str]:
        """Yield the ids of the jobs of the same owner that have succeeded with the same input."""
        yield from filter(is_job_id, map(name_of, self._objects.walk(_folder(job))))

    def remove(self, job: Job) -> None:
        self._objects.delete(computed_key(job))


def fingerprint(job: Job) -> str:
    """Return a hash that is equal for jobs whose results are equal to the byte."""
    given = [job.sha256, job.mesh_format, job.unit, job.up, job.version, sorted(job.parameters.items())]
    return hashlib.sha256(json.dumps(given).encode()).hexdigest()


def _folder(job: Job) -> str:
    return f"computed/{job.owner or NO_OWNER}/{fingerprint(job)}"


def computed_key(job: Job) -> str:
    return f"{_folder(job)}/{job.id}"
