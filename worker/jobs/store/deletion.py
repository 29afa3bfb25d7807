"""Deletion of a job: it disappears at once and for good, even if the process dies during the deletion."""

import time

from worker.jobs.job import Job, is_job_id
from worker.jobs.objects.durable import is_disk_full
from worker.jobs.objects.interface import ObjectStorage
from worker.jobs.store.layout import BEING_DELETED, DELETED, RECORD, job_folder, job_key
from worker.jobs.store.pending import remove_remains
from worker.jobs.store.records import JOB


class Deletions:
    def __init__(self, objects: ObjectStorage) -> None:
        self._objects = objects

    def begin(self, job: Job) -> None:
        """Record that the job is being deleted, so that the janitor can finish, and that it was deleted."""
        try:
            self._objects.put(f"{BEING_DELETED}/{job.id}", JOB.dump_json(job))
            self._remember(job)
        except OSError as error:
            if not is_disk_full(error):  # deletion must work on a full disk
                raise

    def remove_objects(self, job: Job) -> None:
        """Remove the record, and then the other objects of the job."""
        self._objects.delete(job_key(job.id, RECORD))
        self._objects.each(self._objects.delete, self._objects.keys_below(job_folder(job.id)))

    def end(self, job: Job) -> None:
        if not self._objects.exists(f"{DELETED}/{job.id}"):  # the disk was full in begin()
            self._remember(job)
        self._objects.delete(f"{BEING_DELETED}/{job.id}")

    def begun_before(self, age_s: float) -> list[Job]:
        """Return the jobs whose deletion was begun longer ago than this and has not ended."""
        oldest = time.time() - age_s
        keys = [one.key for one in self._objects.list_below(BEING_DELETED) if one.modified_at < oldest]
        records = self._objects.each(self._objects.get, keys)
        return [JOB.validate_json(record) for record in records if record]

    def was_deleted(self, job_id: str, owner: str | None) -> bool:
        """Whether a job of this owner was deleted, as far as it is remembered."""
        return is_job_id(job_id) and self._objects.get(f"{DELETED}/{job_id}") == (owner or "").encode()

    def forget(self, deleted_s: float) -> None:
        """Forget the jobs that were deleted longer ago than this."""
        oldest = time.time() - deleted_s
        for one in self._objects.list_below(DELETED):
            if one.modified_at < oldest:
                if is_job_id(one.name):
                    remove_remains(self._objects, one.name)
                self._objects.delete(one.key)

    def _remember(self, job: Job) -> None:
        self._objects.put(f"{DELETED}/{job.id}", (job.owner or "").encode())
