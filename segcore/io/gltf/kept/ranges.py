"""Ranges of bytes that are needed of a buffer, merged where they overlap or touch."""

from bisect import bisect_right
from dataclasses import dataclass, field


@dataclass(slots=True, eq=False)
class Ranges:
    """A set of ranges; ``merged`` must be called after the last ``add``."""

    _pieces: list[tuple[int, int]] = field(default_factory=list)
    _starts: list[int] = field(default_factory=list)

    def add(self, begin: int, length: int) -> None:
        self._pieces.append((begin, begin + length))

    def merged(self) -> list[tuple[int, int]]:
        """Return the disjoint ranges (begin, end) in ascending order."""
        result: list[tuple[int, int]] = []
        for begin, end in sorted(self._pieces):
            if result and begin <= result[-1][1]:
                result[-1] = result[-1][0], max(end, result[-1][1])
            else:
                result.append((begin, end))
        self._starts = [begin for begin, _ in result]
        return result

    def start_of(self, offset: int) -> int:
        """Return the begin of the merged range that contains a byte."""
        return self._starts[bisect_right(self._starts, offset) - 1]
