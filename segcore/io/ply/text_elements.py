"""Elements of PLY files in text."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from segcore.errors import InvalidMesh
from segcore.io.ply.header import Element, Lists, Rows, cut_short, empty_rows
from segcore.io.polygons import ragged_range
from segcore.io.text.words import find_words, plain_text, whole_numbers

_BLANK = bytes(byte if byte in b"\r\n" else ord(" ") for byte in range(256))


class TextBody:
    """Reads the elements of a text file in their order; line ends are only white space."""

    def __init__(self, data: bytes, offset: int) -> None:
        # Empty lines replace the header, so that the line numbers of errors are those of the file.
        self._words = find_words(plain_text(data[:offset].translate(_BLANK) + data[offset:]))
        self._at = 0

    def read(self, element: Element) -> Rows:
        """Read all rows of the next element.

        Raises
        ------
        InvalidMesh
            If the file ends before they do or a word is not a number; the message has the row or the line.
        """
        if element.count == 0 or not element.properties:
            return empty_rows(element)
        room = self._words.count - self._at
        if element.count * len(element.properties) > room:
            raise cut_short(element, room // len(element.properties))
        return self._equal_rows(element) or self._any_rows(element)

    def finish(self) -> None:
        """Raise InvalidMesh if there are words after the last element."""
        if self._at < self._words.count:
            raise InvalidMesh(
                f"Line {self._words.line_number(self._at)}: the PLY file goes on after the elements that it announces: "
                "correct the numbers in its header."
            )

    def _equal_rows(self, element: Element) -> Rows | None:
        """All rows at once if their lists are as long as those of the first row, else None."""
        at, columns = self._at, []
        for entry in element.properties:
            length = 1
            if entry.count_type is not None:
                if at >= self._words.count or (count := whole_numbers(self._words.numbers(at, at + 1))) is None:
                    return None
                length = int(count[0])
                at += 1
            columns.append((entry, at - self._at, length))
            at += length
        width = at - self._at
        if min(length for _, _, length in columns) < 0 or element.count * width > self._words.count - self._at:
            return None
        table = self._words.numbers(self._at, self._at + element.count * width).reshape(element.count, width)
        numbers, lists = {}, {}
        for entry, first, length in columns:
            values = table[:, first : first + length].reshape(-1)
            if entry.count_type is None:
                numbers[entry.name] = values
            elif (table[:, first - 1] == length).all():
                lists[entry.name] = Lists(values, np.full(element.count, length, dtype=np.int64))
            else:
                return None
        self._at += element.count * width
        return Rows(numbers, lists)

    def _any_rows(self, element: Element) -> Rows:
        """All rows, one at a time."""
        table = self._words.numbers(self._at, self._words.count)
        heads, sizes = self._walk(element, table)
        numbers, lists = {}, {}
        for i, entry in enumerate(element.properties):
            values = table[ragged_range(heads[:, i], sizes[:, i])]
            if entry.count_type is None:
                numbers[entry.name] = values
            else:
                lists[entry.name] = Lists(values, sizes[:, i])
        return Rows(numbers, lists)

    def _walk(self, element: Element, table: NDArray[Any]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """(count, P) the first value of each property of each row in the table, and (count, P) the number of values."""
        values, at = table.tolist(), 0
        heads, sizes = [], []
        is_list = [entry.count_type is not None for entry in element.properties]
        for row in range(element.count):
            for listed in is_list:
                size = 1
                if listed:
                    if at >= len(values):
                        raise cut_short(element, row)
                    size = values[at]
                    at += 1
                if not 0 <= size <= len(values) - at or size != int(size):
                    raise cut_short(element, row)
                heads.append(at)
                sizes.append(int(size))
                at += int(size)
        self._at += at
        shape = (element.count, len(is_list))
        return np.array(heads, dtype=np.int64).reshape(shape), np.array(sizes, dtype=np.int64).reshape(shape)
