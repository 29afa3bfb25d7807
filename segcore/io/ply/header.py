"""The header of a PLY file: its elements and their properties."""

import re
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from segcore.arrays import LongArray
from segcore.errors import InvalidMesh, UnsupportedFormat

_TYPES = {
    "char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4",
    "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4",
    "float": "f4", "float32": "f4", "double": "f8", "float64": "f8",
}  # fmt: skip
_FIRST_LINE = re.compile(rb"ply[ \t]*+(\r+\n|\n\r|\n|\r)", re.IGNORECASE)
_LAST_LINE = re.compile(rb"(?<=[\r\n])end_header[ \t\v\f]*+(?=[\r\n])")
_LINE_END, _LINE_END_OF_CR = re.compile(rb"\r+\n|\n\r|\n"), re.compile(rb"\r\n|\n|\r")
_ENCODINGS: dict[str, Literal["", "<", ">"]] = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}


@dataclass(frozen=True, slots=True)
class Property:
    """A number of an element or, if it has a ``count_type``, a list of numbers preceded by their count."""

    name: str
    type: str  # a NumPy type without byte order
    count_type: str | None = None


@dataclass(frozen=True, slots=True)
class Element:
    """An element: ``count`` rows with the same properties."""

    name: str
    count: int
    properties: tuple[Property, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Lists:
    """A list property: one list of numbers for each row of an element."""

    values: NDArray[Any]  # (sum of sizes,) those of all rows, concatenated
    sizes: LongArray  # (count,)


@dataclass(frozen=True, slots=True, eq=False)
class Rows:
    """The values of an element by the names of its properties."""

    numbers: dict[str, NDArray[Any]]  # (count,) each
    lists: dict[str, Lists]


@dataclass(frozen=True, slots=True, eq=False)
class Elements:
    """The rows of all elements by name, and what was left out of the file."""

    elements: dict[str, Rows]
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Header:
    byte_order: Literal["", "<", ">"]  # empty for text
    elements: tuple[Element, ...]
    size: int  # bytes before the first element


def empty_rows(element: Element) -> Rows:
    nothing = np.zeros(0, dtype=np.int64)
    names = {entry.name: entry.count_type for entry in element.properties}
    return Rows(
        {name: nothing for name, count_type in names.items() if count_type is None},
        {name: Lists(nothing, nothing) for name, count_type in names.items() if count_type is not None},
    )


def cut_short(element: Element, row: int) -> InvalidMesh:
    """Return the error for a file that ends within a row, or seems to because a list has a wrong length."""
    return InvalidMesh(
        f"The PLY file ends within row {row} of the {element.count} rows of its element {element.name[:40]!r}, or a "
        "list there has a wrong length: it is cut short or damaged."
    )


def read_header(data: bytes) -> Header:
    """Read a PLY header; its lines end with a newline, a carriage return or both in any order.

    Lines before the first element that are no statements are ignored.

    Raises
    ------
    InvalidMesh, UnsupportedFormat
        The message has the line.
    """
    lines, size = _split(data)
    byte_order: Literal["", "<", ">"] | None = None
    elements: list[Element] = []
    for number, line in enumerate(lines[1:], start=2):
        match line.split():
            case [] | ["comment" | "obj_info", *_]:
                pass
            case ["format", encoding, *_]:
                byte_order = _encoding(encoding, number)
            case ["element", name, count] if all(name != element.name for element in elements):
                elements.append(Element(name, _count(count, number), ()))
            case ["property", *words] if elements:
                last = elements[-1]
                elements[-1] = Element(last.name, last.count, (*last.properties, _property(words, number)))
            case [keyword, *_] if not elements and keyword not in ("element", "property"):
                pass  # the rest of a comment with a line end in it; here it cannot hide numbers
            case _:
                raise InvalidMesh(f"Line {number}: {line[:80]!r} is not a statement of a PLY header.")
    if byte_order is None:
        raise InvalidMesh("The PLY header has no 'format' line: it must specify ascii or binary.")
    return Header(byte_order, tuple(elements), size)


def _split(data: bytes) -> tuple[list[str], int]:
    """The lines before ``end_header``, and the offset of the first byte after its line.

    The line of ``end_header`` ends as the line before it does, because the first bytes of binary data may be a newline
    or a carriage return too.
    """
    first = _FIRST_LINE.match(data)
    if first is None:
        raise InvalidMesh("The file does not begin with the word 'ply': send a PLY file, or name its real format.")
    last = _LAST_LINE.search(data, first.end())
    if last is None:
        raise InvalidMesh("The PLY header does not end with 'end_header': the file is cut short.")
    line_end = _LINE_END_OF_CR if first[1] == b"\r" else _LINE_END
    header = data[: last.start()]
    ends: list[bytes] = line_end.findall(header)
    likely = (end for end in (*ends[:-2:-1], first[1], b"\r\n", b"\n", b"\r") if data.startswith(end, last.end()))
    lines = [line.decode("latin-1") for line in line_end.split(header)]
    return lines[:-1], last.end() + len(next(likely))


def _encoding(word: str, number: int) -> Literal["", "<", ">"]:
    if word not in _ENCODINGS:
        raise UnsupportedFormat(
            f"Line {number}: PLY files in {word[:40]!r} cannot be read: save it as ascii or binary."
        )
    return _ENCODINGS[word]


def _count(word: str, number: int) -> int:
    if not word.isascii() or not word.isdigit() or len(word) > 18:
        raise InvalidMesh(f"Line {number}: {word[:40]!r} is not a number of elements.")
    return int(word)


def _property(words: list[str], number: int) -> Property:
    match words:
        case ["list", count_type, kind, name] if count_type in _TYPES and kind in _TYPES:
            if _TYPES[count_type].startswith("f"):
                raise InvalidMesh(f"Line {number}: the length of a list must have an integer type.")
            return Property(name, _TYPES[kind], _TYPES[count_type])
        case [kind, name] if kind in _TYPES:
            return Property(name, _TYPES[kind])
        case _:
            raise InvalidMesh(f"Line {number}: {' '.join(words)[:80]!r} is a property of an unknown type.")
