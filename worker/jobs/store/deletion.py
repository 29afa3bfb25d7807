"""Deleting a job: for others it is gone at once and for good, wherever the process dies that does it."""

import time

from worker.jobs.job import Job, is_job_id
from worker.jobs.objects.durable import is_disk_full
from worker.jobs.objects.interface import ObjectStorage
from worker.jobs.store.layout import RECORD, job_folder, job_key
from worker.jobs.store.pending import remove_remains
from worker.jobs.store.records import JOB

_GONE, _DOOMED = "gone", "doomed"


class Deletions:
    def __init__(self, objects: ObjectStorage) -> None:
        self._objects = objects

    def begin(self, job: Job) -> None:
        """Make sure that the deletion will be ended, and known."""
        try:
            self._objects.put(f"{_DOOMED}/{job.id}", JOB.dump_json(job))
            self._note(job)
        except OSError as error:
            if not is_disk_full(error):  # on a full disk deleting must be possible first of all
                raise

    def remove_objects(self, job: Job) -> None:
        """Remove the record, and then the rest."""
        self._objects.delete(job_key(job.id, RECORD))
        self._objects.each(self._objects.delete, self._objects.keys_below(job_folder(job.id)))

    def end(self, job: Job) -> None:
        if not self._objects.exists(f"{_GONE}/{job.id}"):  # the disk was full
            self._note(job)
        self._objects.delete(f"{_DOOMED}/{job.id}")

    def begun_before(self, age_s: float) -> list[Job]:
        """The jobs whose deletion was begun so long ago that whoever did it must have died."""
        oldest = time.time() - age_s
        keys = [one.key for one in self._objects.list_below(_DOOMED) if one.modified_at < oldest]
        records = self._objects.each(self._objects.get, keys)
        return [JOB.validate_json(record) for record in records if record]

    def was_deleted(self, job_id: str, owner: str | None) -> bool:
        return is_job_id(job_id) and self._objects.get(f"{_GONE}/{job_id}") == (owner or "").encode()

    def forget(self, deleted_s: float) -> None:
        """Forget the jobs that were deleted longer ago than this."""
        oldest = time.time() - deleted_s
        for one in self._objects.list_below(_GONE):
            if one.modified_at < oldest:
                if is_job_id(one.name):
                    remove_remains(self._objects, one.name)
                self._objects.delete(one.key)

    def _note(self, job: Job) -> None:
        self._objects.put(f"{_GONE}/{job.id}", (job.owner or "").encode())
