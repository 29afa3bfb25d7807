"""The words of a text file, parsed as numbers in bulk."""

import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from segcore.arrays import BoolArray, FloatArray, LongArray
from segcore.errors import InvalidMesh
from segcore.io.text.number_kernels import parse_floats, parse_integers
from segcore.io.text.word_kernels import Bytes, Lines, Offsets, count_words, find_equal, find_word_starts, has_controls

_WHITE_SPACE = b" \t\n\v\f\r"
_NO_CONTROLS = _WHITE_SPACE + bytes(range(33, 256))
_PADDING = b"\0\x1a"  # of blocks, and the end-of-file mark of DOS
_NUMBER = re.compile(r"[-+]?((\d+\.?\d*|\.\d+)(e[-+]?\d+)?|nan|inf(inity)?)", re.ASCII | re.IGNORECASE)
_NOT_FINITE = re.compile(r"[-+]?(nan\(\w*\)|1\.#(qnan|snan|ind|inf)\d*)", re.ASCII | re.IGNORECASE)  # as C prints them
_EXACT = 2.0**53  # whole numbers up to here are exact in float64


@dataclass(frozen=True, slots=True, eq=False)
class Words:
    """The words and lines of a text; lines without words do not count."""

    text: bytes
    start: Offsets  # (W,) offset of each word
    line_start: Offsets  # (L + 1,) the first word of each line, then W

    @property
    def characters(self) -> Bytes:
        """The bytes of the text as an array."""
        return np.frombuffer(self.text, np.uint8)

    @property
    def lines(self) -> Lines:
        """The same for compiled kernels."""
        return Lines(self.characters, self.start, self.line_start)

    @property
    def count(self) -> int:
        return len(self.start)

    @property
    def ends_with_newline(self) -> bool:
        """Whether the line of the last word ends with a newline."""
        return self.count == 0 or self.text.find(b"\n", int(self.start[-1])) >= 0

    def word(self, index: int) -> str:
        end = self.start[index + 1] if index + 1 < self.count else None
        return self.text[self.start[index] : end].rstrip().decode("ascii", "backslashreplace")

    def line_number(self, index: int) -> int:
        """The line of the file, counted from 1, that contains a word."""
        return self.text.count(b"\n", 0, int(self.start[index])) + 1

    def numbers(self, first: int, last: int) -> NDArray[Any]:
        """Words first..last - 1 as int64, or as float64 if one of them is not a whole number.

        Raises
        ------
        InvalidMesh
            If a word is not a number; the message has its line.
        """
        values = np.empty(last - first, np.int64)
        if parse_integers(self.characters, self.start[first:last], values):
            return values
        return self.floats(first, last)

    def numbers_at(self, indices: LongArray) -> NDArray[Any]:
        """The words at ``indices`` (N,) as int64 or float64; raises InvalidMesh as :meth:`numbers` does."""
        values = np.empty(len(indices), np.int64)
        if parse_integers(self.characters, self.start[indices], values):
            return values
        return self.floats_at(indices)

    def floats(self, first: int, last: int) -> FloatArray:
        """Words first..last - 1 as float64; raises InvalidMesh as :meth:`numbers` does."""
        return self._floats(self.start[first:last], lambda place: first + place)

    def floats_at(self, indices: LongArray) -> FloatArray:
        """The words at ``indices``, of any shape, as float64; raises InvalidMesh as :meth:`numbers` does."""
        flat = indices.reshape(-1)
        return self._floats(self.start[flat], lambda place: int(flat[place])).reshape(indices.shape)

    def _floats(self, starts: Offsets, word_of: Callable[[int], int]) -> FloatArray:
        values, unread = np.empty(len(starts)), np.empty(len(starts), dtype=bool)
        if parse_floats(self.characters, starts, values, unread):
            for i in np.flatnonzero(unread).tolist():
                values[i] = self.float(word_of(i))
        return values

    def float(self, index: int) -> float:
        """One word as a number, including ``inf`` and ``nan`` as C programs print them.

        Raises InvalidMesh with its line if it is not one.
        """
        word = self.word(index)
        if _NOT_FINITE.fullmatch(word):
            return math.nan
        if not _NUMBER.fullmatch(word):
            raise InvalidMesh(f"Line {self.line_number(index)}: {word[:40]!r} is not a number.")
        return float(word)

    def equal(self, indices: NDArray[np.signedinteger[Any]], word: bytes) -> BoolArray:
        """(N,) True for each of the words ``indices`` (N,) that is equal to ``word``."""
        found = np.empty(len(indices), dtype=bool)
        find_equal(self.characters, self.start, indices, np.frombuffer(word, np.uint8), found)
        return found

    def lines_with(self, keyword: bytes) -> BoolArray:
        """(L,) True for each line whose first word is ``keyword``."""
        return self.equal(self.line_start[:-1], keyword)

    def rest_of_line(self, line: int) -> str:
        """What follows the first word of a line, without white space at its ends."""
        begin = int(self.start[self.line_start[line]])
        end = self.text.find(b"\n", begin)
        rest = self.text[begin : end if end >= 0 else None].split(None, 1)[1:]
        return b"".join(rest).strip().decode("utf-8", "replace")


def plain_text(data: bytes) -> bytes:
    """Return the text with newlines as line ends, without byte order mark and without padding at its end.

    Offsets do not change. Line ends of several kinds may be mixed.

    Raises
    ------
    InvalidMesh
        If the text contains control characters: it is damaged or not text.
    """
    data = data.rstrip(_PADDING)
    if has_controls(np.frombuffer(data, np.uint8)):
        first = data.index(data.translate(None, _NO_CONTROLS)[:1])
        raise InvalidMesh(f"Byte {first}: the file has a control character in its text: it is damaged.")
    if b"\r" in data and data.count(b"\r") != data.count(b"\r\n"):
        data = data.replace(b"\r\r\n", b" \r\n").replace(b"\r\n", b" \n").replace(b"\r", b"\n")
    return b"   " + data[3:] if data.startswith(b"\xef\xbb\xbf") else data


def without_comments(text: bytes) -> bytes:
    """Replace everything from a ``#`` to the end of its line by spaces."""
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
    characters = np.frombuffer(text, np.uint8)
    words, newlines = count_words(characters[begin:])
    offset = np.int32 if len(text) < 2**31 else np.int64
    start, line_start = np.empty(words, offset), np.empty(min(words, newlines + 1) + 1, offset)
    lines = find_word_starts(characters, begin, start, line_start)
    return Words(text, start, line_start[: lines + 1])


def whole_numbers(values: NDArray[Any]) -> LongArray | None:
    """The values as int64, or None if one of them is not whole."""
    if values.dtype.kind == "i":
        return values.astype(np.int64, copy=False)
    if not ((np.abs(values) < _EXACT) & (values == np.floor(values))).all():
        return None
    return values.astype(np.int64)
