"""Deletion of a job: it disappears at once and for good, even if the process dies during the deletion."""

import time
from contextlib import suppress

from worker.jobs.job import Job, is_job_id
from worker.jobs.objects.durable import is_disk_full
from worker.jobs.objects.interface import ObjectStorage, name_of
from worker.jobs.store.layout import BEING_DELETED, DELETED, RECORD, job_folder, job_key
from worker.jobs.store.pending import remove_remains
from worker.jobs.store.records import JOB

EARLIER = "gone"  # the folder of earlier versions, in which all ids were in one folder
_FORGOTTEN_AT_ONCE = 500  # memories that a call of ``forget`` checks; set by hand


class Deletions:
    """Deletes the records of jobs and remembers their ids.

    The memories are spread over 4,096 folders by the first digits of the id: in order of time they could not be found
    by id.
    """

    def __init__(self, objects: ObjectStorage) -> None:
        self._objects = objects
        self._checked = ""  # the last key that ``forget`` has checked

    def begin(self, job: Job) -> None:
        """Record that the job is being deleted, so that the janitor can finish, and that it was deleted."""
        try:
            self._objects.put(f"{BEING_DELETED}/{job.id}", JOB.dump_json(job))
            self._remember(job)
        except OSError as error:
            if not is_disk_full(error):  # deletion must work on a full disk
                raise

    def remove_record(self, job: Job) -> None:
        self._objects.delete(job_key(job.id, RECORD))

    def remove_files(self, job: Job) -> None:
        self._objects.each(self._objects.delete, self._objects.keys_below(job_folder(job.id)))

    def end(self, job: Job) -> None:
        if not self._objects.exists(memory_key(job.id)):  # the disk was full in begin()
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
        if not is_job_id(job_id):
            return False
        remembered = (self._objects.get(key) for key in (memory_key(job_id), f"{EARLIER}/{job_id}"))
        return (owner or "").encode() in remembered

    def forget(self, deleted_s: float) -> None:
        """Forget jobs that were deleted longer ago than this; each call checks the next ones."""
        oldest = time.time() - deleted_s
        found = self._objects.list_below(DELETED, self._checked, _FORGOTTEN_AT_ONCE)
        for one in found:
            if one.modified_at < oldest:
                remove_remains(self._objects, one.name)
                self._objects.delete(one.key)
        self._checked = found[-1].key if len(found) == _FORGOTTEN_AT_ONCE else ""

    def move_memory(self, key: str) -> None:
        """Move the memory of a deletion from the folder of earlier versions."""
        job_id = name_of(key)
        if is_job_id(job_id):
            with suppress(FileNotFoundError):
                self._objects.copy(key, memory_key(job_id))
        self._objects.delete(key)

    def _remember(self, job: Job) -> None:
        self._objects.put(memory_key(job.id), (job.owner or "").encode())


def memory_key(job_id: str) -> str:
    return f"{DELETED}/{job_id[:3]}/{job_id}"
