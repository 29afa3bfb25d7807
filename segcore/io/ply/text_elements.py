"""Elements of PLY files in text."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from segcore.arrays import BoolArray, LongArray
from segcore.errors import InvalidMesh
from segcore.io.ply.header import Element, Elements, Header, Lists, Property, Rows, cut_short, empty_rows
from segcore.io.polygons import ragged_range
from segcore.io.text.words import Words, find_words, plain_text, whole_numbers

_LEAST_CORNERS = 3  # of a list on a line with further values
_BLANK = bytes(byte if byte in b"\r\n" else ord(" ") for byte in range(256))


def read_text_elements(data: bytes, header: Header) -> Elements:
    """Read the elements of a text file: each row on a line, or all rows as one stream of words over any lines.

    If a row is a line, the words after those that the header declares are ignored.

    Raises
    ------
    InvalidMesh
        If the file ends before they do or goes on after them, or a word is not a number; the message has the place. If
        there are as many lines as rows, but some are too short: what others have too much is not theirs.
    """
    too_short: InvalidMesh | None = None
    # Empty lines replace the header, so that the line numbers of errors are those of the file.
    words = find_words(plain_text(data[: header.size].translate(_BLANK) + data[header.size :]))
    if len(words.line_start) - 1 == sum(element.count for element in header.elements if element.properties):
        try:
            return _read_lines(words, header)
        except InvalidMesh as error:
            too_short = error
    body = TextBody(words)
    rows = {element.name: body.read(element) for element in header.elements}
    body.finish()
    if too_short is not None:
        raise too_short
    return Elements(rows)


class TextBody:
    """Reads the elements of a text file in their order; line ends are only white space."""

    def __init__(self, words: Words) -> None:
        self._words = words
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
        row = _row_at(self._words, self._at, element)
        rows = None if row is None else _table(self._words, self._at, element, row)
        if row is not None and rows is not None:
            self._at += element.count * row.width
        return rows

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


@dataclass(frozen=True, slots=True)
class _Row:
    """The places of the values of a row: the property, the first word of its values and their number."""

    columns: tuple[tuple[Property, int, int], ...]
    width: int  # words


def _row_at(words: Words, first: int, element: Element) -> _Row | None:
    """The row that begins at a word; None if there is none."""
    at, columns = 0, []
    for entry in element.properties:
        length = 1
        if entry.count_type is not None:
            place = first + at
            if place >= words.count or (count := whole_numbers(words.numbers(place, place + 1))) is None:
                return None
            length = int(count[0])
            at += 1
        columns.append((entry, at, length))
        at += length
    return _Row(tuple(columns), at) if min(length for _, _, length in columns) >= 0 else None


def _table(words: Words, begin: int, element: Element, row: _Row) -> Rows | None:
    """All rows of an element from a word on, if their lists are as long as those of the first row, else None."""
    if element.count * row.width > words.count - begin:
        return None
    table = words.numbers(begin, begin + element.count * row.width).reshape(element.count, row.width)
    numbers, lists = {}, {}
    for entry, first, length in row.columns:
        values = table[:, first : first + length].reshape(-1)
        if entry.count_type is None:
            numbers[entry.name] = values
        elif (table[:, first - 1] == length).all():
            lists[entry.name] = Lists(values, np.full(element.count, length, dtype=np.int64))
        else:
            return None
    return Rows(numbers, lists)


def _read_lines(words: Words, header: Header) -> Elements:
    """The elements if each row is a line; raises InvalidMesh if a line is too short for its row."""
    elements: dict[str, Rows] = {}
    notes = []
    line = 0
    for element in header.elements:
        if element.count == 0 or not element.properties:
            elements[element.name] = empty_rows(element)
            continue
        starts = words.line_start[line : line + element.count + 1].astype(np.int64)
        line += element.count
        row = _row_at(words, int(starts[0]), element)
        rows = None
        if row is not None and (np.diff(starts) == row.width).all():
            rows = _table(words, int(starts[0]), element, row)
        if rows is None:
            rows, ends = _columns(words, starts, element)
            longer = np.flatnonzero(ends < starts[1:])
            for lists in rows.lists.values():
                small = longer[lists.sizes[longer] < _LEAST_CORNERS]
                if len(small):
                    raise _damaged(words, starts, small, "a list is shorter than a face, though its line goes on")
            if len(longer):
                notes.append(_note(element, len(longer), words.line_number(int(ends[longer[0]]))))
        elements[element.name] = rows
    return Elements(elements, tuple(notes))


def _columns(words: Words, starts: LongArray, element: Element) -> tuple[Rows, LongArray]:
    """The rows of an element, each from the first word of its line on, and (count,) the words after them."""
    at, limit = starts[:-1], starts[1:]
    numbers, lists = {}, {}
    for entry in element.properties:
        sizes = np.ones(len(at), dtype=np.int64)
        if entry.count_type is not None:
            _check_lines(words, starts, at < limit)
            lengths = whole_numbers(words.numbers_at(at))
            if lengths is None:
                raise InvalidMesh("The PLY file has a list whose length is not a whole number.")
            sizes, at = lengths, at + 1
        _check_lines(words, starts, (sizes >= 0) & (sizes <= limit - at))
        values = words.numbers_at(at if entry.count_type is None else ragged_range(at, sizes))
        if entry.count_type is None:
            numbers[entry.name] = values
        else:
            lists[entry.name] = Lists(values, sizes)
        at = at + sizes
    return Rows(numbers, lists), at


def _check_lines(words: Words, starts: LongArray, are_right: BoolArray) -> None:
    """Raise InvalidMesh for the first of the lines from ``starts`` on that is not right."""
    wrong = np.flatnonzero(~are_right)
    if len(wrong):
        raise _damaged(words, starts, wrong, "it has fewer values than the header declares")


def _damaged(words: Words, starts: LongArray, lines: LongArray, problem: str) -> InvalidMesh:
    number = words.line_number(int(starts[lines[0]]))
    return InvalidMesh(f"Line {number} of the PLY file: {problem}: it is damaged.")


def _note(element: Element, count: int, line: int) -> str:
    rows = f"{count} of the {element.count} lines of the element {element.name[:40]!r}"
    return f"{rows} have more values than the header declares, first line {line}: the rest of each line was ignored."
