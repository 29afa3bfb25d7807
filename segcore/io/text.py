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

_WHITE_SPACE = b" \t\n\v\f\r"
_NO_CONTROLS = _WHITE_SPACE + bytes(range(33, 256))
_FILLING = b"\0\x1a"  # blocks that were not full, and the end of a file in DOS
_SPACE = 32  # this byte and all below it separate words
_NEWLINE = 10
_BLOCK = 2**20  # bytes that are looked at together, so that the helper arrays stay in the cache
_INT64 = np.iinfo(np.int64)
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
        try:
            values = parse_numbers(self._between(first, last), last - first, np.int64)
        except ValueError:
            return self.floats(first, last)
        too_large = (values == _INT64.max) | (values == _INT64.min)  # NumPy does not say when it cuts a number down
        return self.floats(first, last) if too_large.any() else values

    def floats(self, first: int, last: int) -> FloatArray:
        """Words first..last - 1 as float64; raises InvalidMesh as :meth:`numbers` does."""
        try:
            return parse_numbers(self._between(first, last), last - first, np.float64)
        except ValueError:
            bad = first_bad(first, last, lambda low, high: are_numbers(self._between(low, high), high - low))
            raise InvalidMesh(f"Line {self.line_number(bad)}: {self.word(bad)[:40]!r} is not a number.") from None

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
        return self.equal(self.line_start[:-1], keyword)

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
    if controls := data.translate(None, _NO_CONTROLS):
        raise InvalidMesh(
            f"Byte {data.index(controls[0])}: the file has a control character in its text: it is damaged."
        )
    if b"\r" in data and b"\n" not in data:
        data = data.replace(b"\r", b"\n")
    return b"   " + data[3:] if data.startswith(b"\xef\xbb\xbf") else data


def without_comments(text: bytes) -> bytes:
    """The text with everything from a ``#`` to the end of its line turned into spaces."""
    return _COMMENT.sub(lambda comment: b" " * len(comment[0]), text) if b"#" in text else text


def find_words(text: bytes) -> Words:
    """Find all words of a text."""
    letters = np.frombuffer(text, np.uint8)
    starts, newlines = [], []
    for offset in range(0, len(letters), _BLOCK):
        block = letters[offset : offset + _BLOCK]
        space = np.empty(len(block) + 1, dtype=bool)
        space[0] = offset == 0 or letters[offset - 1] <= _SPACE
        np.less_equal(block, _SPACE, out=space[1:])
        starts.append(np.flatnonzero(space[:-1] > space[1:]) + offset)
        newlines.append(np.flatnonzero(block == _NEWLINE) + offset)
    start = np.concatenate([np.zeros(0, dtype=np.int64), *starts])
    before_newline = np.searchsorted(start, np.concatenate([np.zeros(0, dtype=np.int64), *newlines]))
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
