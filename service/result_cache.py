"""Results that were opened or drawn lately: they never change, so a few stay in memory."""

from collections.abc import Callable
from dataclasses import fields
from typing import Any

from segcore.io.result import Segmentation, read_result
from service.lru import LruCache
from worker.jobs.store.store import JobStore


class ResultCache:
    """The opened results of the store, and the bytes that were made of them."""

    def __init__(self, store: JobStore, max_opened_bytes: int, max_rendered_bytes: int) -> None:
        self._store = store
        self._opened: LruCache[str, Segmentation] = LruCache(max_opened_bytes, _size_bytes)
        self._rendered: LruCache[tuple[str, str], bytes] = LruCache(max_rendered_bytes, len)

    def get(self, job_id: str) -> Segmentation:
        """The result of a job that succeeded.

        Raises
        ------
        UnknownJob
            Where the job was deleted.
        """
        return self._opened.get(job_id, lambda: self._read(job_id))

    def rendered(self, job_id: str, name: str, render: Callable[[], bytes]) -> bytes:
        """What is made of the result of a job under a name that says everything about how."""
        return self._rendered.get((job_id, name), render)

    def drop(self, job_id: str) -> None:
        self._opened.drop(lambda key: key == job_id)
        self._rendered.drop(lambda key: key[0] == job_id)

    def _read(self, job_id: str) -> Segmentation:
        with self._store.results.open(job_id) as file:
            return read_result(file)


def _size_bytes(segmentation: Segmentation) -> int:
    parts: tuple[Any, ...] = (segmentation.mesh, segmentation.hierarchy)
    values = [getattr(part, field.name) for part in parts for field in fields(part)]
    return sum(getattr(value, "nbytes", 0) for value in values)
