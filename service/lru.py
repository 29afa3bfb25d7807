"""What was made or opened lately, as much of it as fits into a given memory."""

from collections import OrderedDict
from collections.abc import Callable, Hashable
from threading import Lock
from typing import Generic, TypeVar

Key = TypeVar("Key", bound=Hashable)
Value = TypeVar("Value")


class LruCache(Generic[Key, Value]):
    """Values that never change, the least recently used dropped first when they outgrow their memory."""

    def __init__(self, max_bytes: int, size_bytes: Callable[[Value], int]) -> None:
        self._max_bytes = max_bytes
        self._size_bytes = size_bytes
        self._values: OrderedDict[Key, Value] = OrderedDict()
        self._held_bytes = 0
        self._lock = Lock()

    def get(self, key: Key, make: Callable[[], Value]) -> Value:
        """The value of a key, made where it is not there; two callers at once may both make it."""
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

    def drop(self, is_doomed: Callable[[Key], bool]) -> None:
        with self._lock:
            for key in [key for key in self._values if is_doomed(key)]:
                self._remove(key)

    def _remove(self, key: Key) -> None:
        if key in self._values:
            self._held_bytes -= self._size_bytes(self._values.pop(key))
