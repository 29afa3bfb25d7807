"""Storage that fails, and functions that are killed, at any write."""

from collections.abc import Callable, Iterator
from typing import Any

from worker.jobs.objects.interface import ObjectStorage

WRITES = ("create", "put", "put_file", "copy", "delete")


class Killed(BaseException):
    """Stands for the death of the process."""


class FailingObjects:
    """Storage whose n-th write, and all after it, fail; the n-th fails before or after it is done."""

    def __init__(self, objects: ObjectStorage, write: int, error: BaseException, *, is_done: bool = False) -> None:
        self._objects = objects
        self._left = write
        self._error = error
        self._is_done = is_done

    @property
    def has_failed(self) -> bool:
        return self._left < 0

    def __getattr__(self, name: str) -> Any:
        method = getattr(self._objects, name)
        return method if name not in WRITES else lambda *given, **named: self._write(method, *given, **named)

    def _write(self, method: Callable[..., object], *given: object, **named: object) -> object:
        self._left -= 1
        if self._left == -1 and self._is_done:
            method(*given, **named)
        if self._left < 0:
            raise self._error
        return method(*given, **named)


def killed_at_every_write(
    objects: ObjectStorage, act: Callable[[Any], object], prepare: Callable[[], object] = lambda: None
) -> Iterator[int]:
    """Call a function again and again, killed at its first write, at its second, ..., until it is not killed."""
    for write in range(100):
        for is_done in (False, True):
            prepare()
            failing = FailingObjects(objects, write, Killed(), is_done=is_done)
            try:
                act(failing)
            except Killed:
                yield write
            if not failing.has_failed:
                assert write > 1
                return
    raise AssertionError("the function does not end")
