"""The words of a text file, found and turned into numbers in bulk."""

import re
import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from segcore.arrays import FloatArray, LongArray
from segcore.errors import InvalidMesh

_SPACE = 32  # this byte and all below it separate words
_NEWLINE = 10
_EXACT = 2.0**53  # whole numbers up to here are exact in float64
_COMMENT = re.compile(rb"#[^\n]*")


@dataclass(frozen=True, slots=True, eq=False)
class Words:
    """Where the words and the lines of a text are; lines without a word do not count."""

    text: bytes
    start: LongArray  # (W,) offset of every word
    line_start: LongArray  # (L + 1,) the first word of every line, and W

    @property
    def count(self) -> int:
        return len(self.start)

    def word(self, index: int) -> str:
        return bytes(self.text[self.start[index] :].split(None, 1)[0][:40]).decode("ascii", "backslashreplace")

    def line_number(self, index: int) -> int:
        """The line of the file, counted from 1, in which a word stands."""
        return self.text.count(b"\n", 0, int(self.start[index])) + 1

    def numbers(self, first: int, last: int) -> NDArray[Any]:
        """Words first..last - 1 as int64, or as float64 where one of them is not a whole number.

        Raises
        ------
        InvalidMesh
            Where a word is not a number; the message has its line.
        """
        try:
            return parse_numbers(self._between(first, last), last - first, np.int64)
        except ValueError:
            return self.floats(first, last)

    def floats(self, first: int, last: int) -> FloatArray:
        """Words first..last - 1 as float64; raises InvalidMesh as :meth:`numbers` does."""
        try:
            return parse_numbers(self._between(first, last), last - first, np.float64)
        except ValueError:
            bad = next((i for i in range(first, last) if not _is_number(self.word(i))), first)
            raise InvalidMesh(f"Line {self.line_number(bad)}: {self.word(bad)!r} is not a number.") from None

    def _between(self, first: int, last: int) -> bytes:
        if first >= last:
            return b""
        return self.text[self.start[first] : self.start[last] if last < self.count else None]


def plain_text(data: bytes) -> bytes:
    """The text with every line ended by a newline byte and without a byte order mark; no offset changes."""
    if b"\r" in data and b"\n" not in data:
        data = data.replace(b"\r", b"\n")
    return b"   " + data[3:] if data.startswith(b"\xef\xbb\xbf") else data


def without_comments(text: bytes) -> bytes:
    """The text with everything from a ``#`` to the end of its line turned into spaces."""
    return _COMMENT.sub(lambda comment: b" " * len(comment[0]), text) if b"#" in text else text


def find_words(text: bytes) -> Words:
    """Find all words of a text."""
    letters = np.frombuffer(text, np.uint8)
    inside = letters > _SPACE
    begins = inside.copy()
    begins[1:] &= ~inside[:-1]
    start = np.flatnonzero(begins)
    before_newline = np.searchsorted(start, np.flatnonzero(letters == _NEWLINE))
    bounds = np.concatenate([[0], before_newline, [len(start)]])
    filled = np.flatnonzero(np.diff(bounds))
    return Words(text, start, np.append(bounds[filled], len(start)))


def parse_numbers(text: bytes, count: int, dtype: type[np.generic]) -> NDArray[Any]:
    """Exactly ``count`` numbers, separated by white space; ValueError where the text is anything else."""
    with warnings.catch_warnings():  # NumPy warns of, or with later versions raises, what the count shows as well
        warnings.simplefilter("ignore", DeprecationWarning)
        values = np.fromstring(text + b" 0", dtype=dtype, sep=" ")
    if len(values) != count + 1:
        raise ValueError(f"{len(values) - 1} numbers in place of {count}")
    return values[:-1]


def whole_numbers(values: NDArray[Any]) -> LongArray | None:
    """Values that are all whole as int64, or None where one is not."""
    if values.dtype.kind == "i":
        return values.astype(np.int64, copy=False)
    if not ((np.abs(values) < _EXACT) & (values == np.floor(values))).all():
        return None
    return values.astype(np.int64)


def _is_number(word: str) -> bool:
    try:
        parse_numbers(word.encode("ascii", "replace"), 1, np.float64)
    except ValueError:
        return False
    return True
