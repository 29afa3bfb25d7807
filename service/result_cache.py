"""An in-memory LRU cache of opened results and of the files rendered from them."""

from collections import OrderedDict
from collections.abc import Callable, Hashable
from dataclasses import fields
from threading import Lock
from typing import Any, Generic, TypeVar

from segcore.io import Edited, Segmentation, read_result
from worker.jobs.store.revisions import RevisionDamaged
from worker.jobs.store.store import JobStore

Key = TypeVar("Key", bound=Hashable)
Value = TypeVar("Value")


class LruCache(Generic[Key, Value]):
    """Immutable values of a limited total size; the least recently used are dropped first."""

    def __init__(self, max_bytes: int, size_bytes: Callable[[Value], int]) -> None:
        self._max_bytes = max_bytes
        self._size_bytes = size_bytes
        self._values: OrderedDict[Key, Value] = OrderedDict()
        self._held_bytes = 0
        self._lock = Lock()

    def get(self, key: Key, make: Callable[[], Value]) -> Value:
        """Return the value of a key, made if it is not cached; two concurrent callers may both make it."""
        with self._lock:
            if key in self._values:
                self._values.move_to_end(key)
                return self._values[key]
        value = make()
        with self._lock:
            self._remove(key)
            self._values[key] = value
            self._held_bytes += self._size_bytes(value)
            while self._held_bytes > self._max_bytes:
                self._remove(next(iter(self._values)))
        return value

    def drop(self, matches: Callable[[Key], bool]) -> None:
        """Remove all values whose key matches."""
        with self._lock:
            for key in [key for key in self._values if matches(key)]:
                self._remove(key)

    def _remove(self, key: Key) -> None:
        if key in self._values:
            self._held_bytes -= self._size_bytes(self._values.pop(key))


class ResultCache:
    """The opened results of a store, and the files rendered from them."""

    def __init__(self, store: JobStore, max_opened_bytes: int, max_rendered_bytes: int) -> None:
        self._store = store
        self._opened: LruCache[tuple[str, int], Segmentation] = LruCache(max_opened_bytes, _size_bytes)
        self._rendered: LruCache[tuple[str, str], bytes] = LruCache(max_rendered_bytes, len)

    def get(self, job_id: str) -> Segmentation:
        """Return the result of a job that succeeded.

        Raises
        ------
        UnknownJob
            If the job was deleted.
        """
        return self._opened.get((job_id, 0), lambda: self._read(job_id))

    def revised(self, job_id: str, number: int) -> Segmentation:
        """Return the mesh of a job with the parts of a revision: as the hierarchy, and as they were edited.

        Raises
        ------
        UnknownJob
            If the job was deleted.
        UnknownRevision, RevisionDamaged
        """
        return self._opened.get((job_id, number), lambda: self._read_revision(job_id, number))

    def rendered(self, job_id: str, name: str, render: Callable[[], bytes]) -> bytes:
        """Return a file rendered from a result; ``name`` must identify the format and all of its options."""
        return self._rendered.get((job_id, name), render)

    def drop(self, job_id: str) -> None:
        """Remove everything that belongs to a job."""
        self._opened.drop(lambda key: key[0] == job_id)
        self._rendered.drop(lambda key: key[0] == job_id)

    def _read(self, job_id: str) -> Segmentation:
        with self._store.results.open(job_id) as file:
            return read_result(file)

    def _read_revision(self, job_id: str, number: int) -> Segmentation:
        partition, mesh = self._store.revisions.partition(job_id, number), self.get(job_id).mesh
        if len(partition.labels) != len(mesh.faces):
            raise RevisionDamaged(number)
        return Segmentation(mesh, partition.hierarchy(mesh), Edited(partition))


def _size_bytes(segmentation: Segmentation) -> int:
    parts: list[Any] = [segmentation.mesh, segmentation.hierarchy]
    if segmentation.edited is not None:  # the mesh is that of the job
        parts = [segmentation.hierarchy, segmentation.edited.partition]
    values = [getattr(part, field.name) for part in parts for field in fields(part)]
    return sum(getattr(value, "nbytes", 0) for value in values)
