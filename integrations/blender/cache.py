"""Results that were computed, by the meshes that they belong to, for the next change in the redo panel."""

from collections import OrderedDict
from typing import Any


class Cache:
    """The latest results; the sizes of those that are kept add up to at most a limit when :meth:`trim` returns."""

    def __init__(self, limit: int) -> None:
        self._limit = limit
        self._results: OrderedDict[str, tuple[Any, int]] = OrderedDict()

    def __contains__(self, key: str) -> bool:
        return key in self._results

    def __getitem__(self, key: str) -> Any:
        self._results.move_to_end(key)
        return self._results[key][0]

    def put(self, key: str, result: Any, size: int) -> None:
        self._results[key] = result, size
        self._results.move_to_end(key)

    def discard(self, key: str) -> None:
        """Forget a result, if there is one."""
        self._results.pop(key, None)

    def trim(self) -> None:
        """Forget the results that have not been used for longest."""
        size = sum(size for _, size in self._results.values())
        while size > self._limit:
            size -= self._results.popitem(last=False)[1][1]

    def clear(self) -> None:
        self._results.clear()
