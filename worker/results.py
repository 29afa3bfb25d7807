"""The result files of jobs."""

from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO

from worker.file_cache import FileCache
from worker.layout import RESULT, job_key
from worker.objects import ObjectStorage
from worker.spool import Spool


class ResultFiles:
    def __init__(self, objects: ObjectStorage, spool: Spool, cache: FileCache | None) -> None:
        """``cache`` keeps on this machine what was fetched from another; results never change."""
        self._objects = objects
        self._spool = spool
        self._cache = cache

    def write(self, job_id: str, write: Callable[[BinaryIO], object]) -> None:
        """Store the result of a job, whole; a second writer of the same job writes the same bytes."""
        path = self._spool.result_file(job_id)
        try:
            with path.open("xb") as file:
                write(file)
            self.put(job_id, path)
        finally:
            path.unlink(missing_ok=True)

    def put(self, job_id: str, path: Path) -> None:
        """Store the result of a job from a file, which may be gone afterwards."""
        self._objects.put_file(job_key(job_id, RESULT), path)

    def open(self, job_id: str) -> BinaryIO:
        """The result of a job.

        Raises
        ------
        FileNotFoundError
            Where there is none.
        """
        key = job_key(job_id, RESULT)
        if self._cache is None:
            return self._objects.open(key)
        return self._cache.open(job_id, lambda: self._objects.open(key))

    def remove(self, job_id: str) -> None:
        self._objects.delete(job_key(job_id, RESULT))

    def drop(self, job_id: str) -> None:
        if self._cache is not None:
            self._cache.drop(job_id)

    def presigned_url(self, job_id: str, valid_s: float) -> str | None:
        return self._objects.presigned_url(job_key(job_id, RESULT), valid_s)
