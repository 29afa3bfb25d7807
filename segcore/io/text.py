"""The words of a text file, found and turned into numbers in bulk."""

import re
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from segcore.arrays import BoolArray, FloatArray, LongArray
from segcore.errors import InvalidMesh
from segcore.io.number_kernels import parse_floats, parse_integers
from segcore.io.text_kernels import (
    Offsets,
    count_words,
    find_lines_with,
    find_word_starts,
    has_controls,
)

_WHITE_SPACE = b" \t\n\v\f\r"
_NO_CONTROLS = _WHITE_SPACE + bytes(range(33, 256))
_FILLING = b"\0\x1a"  # blocks that were not full, and the end of a file in DOS
_SPACE = 32  # this byte and all below it separate words
_NUMBER = re.compile(r"[-+]?((\d+\.?\d*|\.\d+)(e[-+]?\d+)?|nan|inf(inity)?)", re.ASCII | re.IGNORECASE)
_EXACT = 2.0**53  # whole numbers up to here are exact in float64


@dataclass(frozen=True, slots=True, eq=False)
class Words:
    """Where the words and the lines of a text are; lines without a word do not count."""

    text: bytes
    start: Offsets  # (W,) offset of every word
    line_start: Offsets  # (L + 1,) the first word of every line, and W

    @property
    def letters(self) -> NDArray[np.uint8]:
        """The bytes of the text."""
        return np.frombuffer(self.text, np.uint8)

    @property
    def count(self) -> int:
        return len(self.start)

    def word(self, index: int) -> str:
        return self._between(index, index + 1).rstrip().decode("ascii", "backslashreplace")

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
        values = np.empty(last - first, np.int64)
        if parse_integers(self.letters, self.start[first:last], values):
            return values
        return self.floats(first, last)

    def floats(self, first: int, last: int) -> FloatArray:
        """Words first..last - 1 as float64; raises InvalidMesh as :meth:`numbers` does."""
        return self._floats(self.start[first:last], lambda place: first + place)

    def floats_at(self, indices: LongArray) -> FloatArray:
        """The words at ``indices``, of any shape, as float64; raises InvalidMesh as :meth:`numbers` does."""
        flat = indices.reshape(-1)
        return self._floats(self.start[flat], lambda place: int(flat[place])).reshape(indices.shape)

    def _floats(self, starts: Offsets, word_of: Callable[[int], int]) -> FloatArray:
        values, unread = np.empty(len(starts)), np.empty(len(starts), dtype=bool)
        if parse_floats(self.letters, starts, values, unread):
            for i in np.flatnonzero(unread).tolist():
                values[i] = self.float(word_of(i))
        return values

    def float(self, index: int) -> float:
        """One word as a number, also as infinity or as none; raises InvalidMesh with the line where it is another."""
        word = self.word(index)
        if not _NUMBER.fullmatch(word):
            raise InvalidMesh(f"Line {self.line_number(index)}: {word[:40]!r} is not a number.")
        return float(word)

    def equal(self, indices: LongArray, word: bytes) -> BoolArray:
        """(N,): which of the words at ``indices`` are ``word``."""
        places = len(self.text) - len(word) + 1
        if places <= 0:
            return np.zeros(len(indices), dtype=bool)
        first = self.start[indices]
        from_here = np.ndarray(places, f"S{len(word)}", self.text, strides=(1,))
        same = (from_here[np.minimum(first, places - 1)] == word) & (first < places)
        end = first + len(word)
        is_end = np.frombuffer(self.text, np.uint8).take(end, mode="clip") <= _SPACE
        return same & (is_end | (end == len(self.text)))

    def lines_with(self, keyword: bytes) -> BoolArray:
        """(L,): the lines whose first word is ``keyword``."""
        found = np.empty(len(self.line_start) - 1, dtype=bool)
        find_lines_with(self.letters, self.start, self.line_start, np.frombuffer(keyword, np.uint8), found)
        return found

    def text_of_lines(self, selected: BoolArray) -> bytes:
        """The text of the lines for which ``selected``, (L,), is true, one after the other."""
        bounds = np.append(self.start[self.line_start[:-1]], len(self.text))
        changes = np.flatnonzero(np.diff(selected, prepend=False, append=False))
        runs = bounds[changes].reshape(-1, 2).tolist()
        return b"".join([self.text[first:last] for first, last in runs])

    def _between(self, first: int, last: int) -> bytes:
        if first >= last:
            return b""
        return self.text[self.start[first] : self.start[last] if last < self.count else None]


def plain_text(data: bytes) -> bytes:
    """The text with every line ended by a newline byte, without a byte order mark and bytes that only fill up its end.

    No offset changes.

    Raises
    ------
    InvalidMesh
        Where there are control characters in it: it is damaged or no text.
    """
    data = data.rstrip(_FILLING)
    if has_controls(np.frombuffer(data, np.uint8)):
        first = data.index(data.translate(None, _NO_CONTROLS)[:1])
        raise InvalidMesh(f"Byte {first}: the file has a control character in its text: it is damaged.")
    if b"\r" in data and b"\n" not in data:
        data = data.replace(b"\r", b"\n")
    return b"   " + data[3:] if data.startswith(b"\xef\xbb\xbf") else data


def without_comments(text: bytes) -> bytes:
    """The text with everything from a ``#`` to the end of its line turned into spaces."""
    pieces: list[bytes | memoryview] = []
    at = 0
    while (begin := text.find(b"#", at)) >= 0:
        newline = text.find(b"\n", begin)
        end = newline if newline >= 0 else len(text)
        pieces += [memoryview(text)[at:begin], b" " * (end - begin)]
        at = end
    return b"".join([*pieces, memoryview(text)[at:]]) if pieces else text


def find_words(text: bytes, begin: int = 0) -> Words:
    """Find all words of a text from byte ``begin`` on."""
    letters = np.frombuffer(text, np.uint8)
    words, newlines = count_words(letters[begin:])
    offset = np.int32 if len(text) < 2**31 else np.int64
    start, line_start = np.empty(words, offset), np.empty(min(words, newlines + 1) + 1, offset)
    lines = find_word_starts(letters, begin, start, line_start)
    return Words(text, start, line_start[: lines + 1])


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


def are_numbers(text: bytes, count: int) -> bool:
    """Whether a text is exactly ``count`` numbers."""
    try:
        parse_numbers(text, count, np.float64)
    except ValueError:
        return False
    return True


def first_bad(low: int, high: int, are_good: Callable[[int, int], bool]) -> int:
    """The first bad one of low..high - 1, of which one is; ``are_good(a, b)`` says whether all of a..b - 1 are good.

    By bisection, as looking at them one by one would take a long time for files of many millions.
    """
    while high - low > 1:
        middle = (low + high) // 2
        if are_good(low, middle):
            low = middle
        else:
            high = middle
    return low
