"""The header of a PLY file: its elements and their properties."""

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
    """Read a PLY header; its lines end with a newline, a carriage return or both.

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
            case _:
                raise InvalidMesh(f"Line {number}: {line[:80]!r} is not a statement of a PLY header.")
    if byte_order is None:
        raise InvalidMesh("The PLY header has no 'format' line: it must specify ascii or binary.")
    return Header(byte_order, tuple(elements), size)


def _split(data: bytes) -> tuple[list[str], int]:
    """The lines before ``end_header``, and the offset of the first byte after its line."""
    if not data.startswith((b"ply\n", b"ply\r")):
        raise InvalidMesh("The file does not begin with the word 'ply': send a PLY file, or name its real format.")
    newline = b"\r\n" if data.startswith(b"ply\r\n") else data[3:4]
    end = data.find(newline + b"end_header")
    after = data.find(newline, end + len(newline))
    if end < 0 or after < 0 or data[end:after].strip() != b"end_header":
        raise InvalidMesh("The PLY header does not end with 'end_header': the file is cut short.")
    return data[:end].decode("latin-1").split(newline.decode()), after + len(newline)


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
