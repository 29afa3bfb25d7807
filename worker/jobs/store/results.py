"""The result files of jobs."""

from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO

from worker.jobs.objects.file_cache import FileCache
from worker.jobs.objects.interface import ObjectStorage
from worker.jobs.store.layout import RESULT, job_key
from worker.jobs.store.records import Records, UnknownJob
from worker.jobs.store.spool import Spool


class ResultFiles:
    """Reads and writes result files; a write raises UnknownJob if the job has been deleted, also during the write."""

    def __init__(self, objects: ObjectStorage, records: Records, spool: Spool, cache: FileCache | None) -> None:
        """``cache`` is for results of a remote storage, which never change."""
        self._objects = objects
        self._records = records
        self._spool = spool
        self._cache = cache

    def write(self, job_id: str, write: Callable[[BinaryIO], object]) -> None:
        """Store the result of a job that a function writes; a second run of the job writes the same bytes."""
        self._records.require(job_id)
        path = self._spool.result_file(job_id)
        try:
            with path.open("xb") as file:
                write(file)
            self.put(job_id, path)
        finally:
            path.unlink(missing_ok=True)

    def put(self, job_id: str, path: Path) -> None:
        """Store the result of a job from a file, which may be moved."""
        key = job_key(job_id, RESULT)
        self._records.require(job_id)
        self._objects.put_file(key, path)
        self._records.require(job_id, lambda: self._objects.delete(key))

    def share(self, job_id: str, other_id: str) -> None:
        """Give a job the result of another one.

        Raises
        ------
        FileNotFoundError
            If the other one has none.
        """
        key = job_key(other_id, RESULT)
        self._records.require(other_id)
        self._objects.copy(job_key(job_id, RESULT), key)
        self._records.require(other_id, lambda: self._objects.delete(key))

    def open(self, job_id: str) -> BinaryIO:
        """Open the result of a job.

        Raises
        ------
        UnknownJob
            If there is none.
        """
        key = job_key(job_id, RESULT)
        try:
            if self._cache is None:
                return self._objects.open(key)
            return self._cache.open(job_id, lambda: self._objects.open(key))
        except FileNotFoundError as error:
            raise UnknownJob(job_id) from error

    def drop(self, job_id: str) -> None:
        """Remove the result of a job from the cache."""
        if self._cache is not None:
            self._cache.drop(job_id)

    def presigned_url(self, job_id: str, valid_s: float) -> str | None:
        """Return a URL from which anyone can fetch the result for a time; None if the storage has none."""
        return self._objects.presigned_url(job_key(job_id, RESULT), valid_s)
