"""Results that were opened lately: they never change, so a few stay in memory."""

from collections import OrderedDict
from dataclasses import fields
from threading import Lock
from typing import Any

from segcore.io.result import Segmentation, read_result
from worker.store import LocalStore


class ResultCache:
    """The results of the store, the least recently used dropped first when they outgrow their memory."""

    def __init__(self, store: LocalStore, max_bytes: int) -> None:
        self._store = store
        self._max_bytes = max_bytes
        self._opened: OrderedDict[str, Segmentation] = OrderedDict()
        self._lock = Lock()

    def get(self, job_id: str) -> Segmentation:
        """The result of a job that succeeded.

        Raises
        ------
        UnknownJob
            Where the job was deleted.
        """
        with self._lock:
            if job_id in self._opened:
                self._opened.move_to_end(job_id)
                return self._opened[job_id]
        with self._store.open_result(job_id) as file:
            segmentation = read_result(file)
        with self._lock:
            self._opened[job_id] = segmentation
            self._shrink()
        return segmentation

    def drop(self, job_id: str) -> None:
        with self._lock:
            self._opened.pop(job_id, None)

    def _shrink(self) -> None:
        size = sum(_size_bytes(opened) for opened in self._opened.values())
        while size > self._max_bytes:
            _, dropped = self._opened.popitem(last=False)
            size -= _size_bytes(dropped)


def _size_bytes(segmentation: Segmentation) -> int:
    parts: tuple[Any, ...] = (segmentation.mesh, segmentation.hierarchy)
    values = [getattr(part, field.name) for part in parts for field in fields(part)]
    return sum(getattr(value, "nbytes", 0) for value in values)
