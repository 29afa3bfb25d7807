"""Elements of binary PLY files."""

from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from segcore.io.ply.header import Element, Lists, Property, Rows, cut_short, empty_rows

_BYTE_ORDERS: dict[str, Literal["little", "big"]] = {"<": "little", ">": "big"}


class BinaryBody:
    """Reads the elements of a binary file in their order; bytes after the last one are ignored, as elsewhere."""

    def __init__(self, data: bytes, offset: int, byte_order: str) -> None:
        self._data = data
        self._at = offset
        self._order = byte_order

    def read(self, element: Element) -> Rows:
        """Read all rows of the next element.

        Raises
        ------
        InvalidMesh
            If the file ends before they do; the message has the element and the row.
        """
        if element.count == 0 or not element.properties:
            return empty_rows(element)
        least = sum(np.dtype(entry.count_type or entry.type).itemsize for entry in element.properties)
        room = len(self._data) - self._at
        if element.count * least > room:
            raise cut_short(element, room // least)
        return self._equal_rows(element) or self._any_rows(element)

    def _equal_rows(self, element: Element) -> Rows | None:
        """All rows at once if their lists are as long as those of the first row, else None."""
        lengths = self._lengths_of_next_row(element)
        if lengths is None:
            return None
        fields = [self._fields(entry, length) for entry, length in zip(element.properties, lengths, strict=True)]
        row = np.dtype([(f"{i} {name}", *form) for i, field in enumerate(fields) for name, *form in field])
        if element.count * row.itemsize > len(self._data) - self._at:
            return None
        table = np.frombuffer(self._data, row, element.count, self._at)
        numbers, lists = {}, {}
        for i, (entry, length) in enumerate(zip(element.properties, lengths, strict=True)):
            if entry.count_type is None:
                numbers[entry.name] = table[f"{i} values"]
            elif (table[f"{i} length"] == length).all():
                sizes = np.broadcast_to(np.int64(length), element.count)
                lists[entry.name] = Lists(_joined(table[f"{i} values"]), sizes)
            else:
                return None
        self._at += element.count * row.itemsize
        return Rows(numbers, lists)

    def _fields(self, entry: Property, length: int) -> list[tuple[Any, ...]]:
        if entry.count_type is None:
            return [("values", self._order + entry.type)]
        return [("length", self._order + entry.count_type), ("values", self._order + entry.type, (length,))]

    def _lengths_of_next_row(self, element: Element) -> list[int] | None:
        """The length of each list of the next row, and 1 for each number; None if the file ends within the row."""
        lengths, at = [], self._at
        for entry in element.properties:
            length, at = self._length(entry, at)
            lengths.append(length)
            at += length * np.dtype(entry.type).itemsize
        return lengths if at <= len(self._data) and min(lengths) >= 0 else None

    def _length(self, entry: Property, at: int) -> tuple[int, int]:
        """The number of values of a property, and the offset of the first one."""
        if entry.count_type is None:
            return 1, at
        values = at + np.dtype(entry.count_type).itemsize
        signed = entry.count_type.startswith("i")
        return int.from_bytes(self._data[at:values], _BYTE_ORDERS[self._order], signed=signed), values

    def _any_rows(self, element: Element) -> Rows:
        """All rows, one at a time."""
        sizes: list[list[int]] = [[] for _ in element.properties]
        parts: list[list[bytes]] = [[] for _ in element.properties]
        columns = list(zip(element.properties, sizes, parts, strict=True))
        width = {entry: np.dtype(entry.type).itemsize for entry in element.properties}
        data, at = self._data, self._at
        for row in range(element.count):
            for entry, lengths, values in columns:
                length, at = self._length(entry, at)
                end = at + length * width[entry]
                lengths.append(length)
                values.append(data[at:end])
                if length < 0 or end > len(data):
                    raise cut_short(element, row)
                at = end
        self._at = at
        numbers, lists = {}, {}
        for entry, lengths, values in columns:
            joined = np.frombuffer(b"".join(values), self._order + entry.type)
            if entry.count_type is None:
                numbers[entry.name] = joined
            else:
                lists[entry.name] = Lists(joined, np.array(lengths, dtype=np.int64))
        return Rows(numbers, lists)


def _joined(rows: NDArray[Any]) -> NDArray[Any]:
    """(N * K,) a copy of rows (N, K) that are not contiguous; each row is copied as one item, which is much faster."""
    if rows.size == 0:
        return rows.reshape(-1)
    whole_rows = rows.view(f"V{rows.dtype.itemsize * rows.shape[1]}")
    return np.ascontiguousarray(whole_rows).view(rows.dtype).reshape(-1)
