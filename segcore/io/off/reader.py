"""The OFF reader (Geomview's object file format, in text)."""

import math
import re
from typing import Any

import numpy as np
from numpy.typing import NDArray

from segcore.appearance import Appearance, appearance_or_none, color_bytes, texture_coordinates, unit_normals
from segcore.arrays import FloatArray, LongArray
from segcore.errors import InvalidMesh, UnsupportedFormat
from segcore.io.limits import ReadLimits
from segcore.io.polygons import Polygons, mesh_of_polygons, ragged_range
from segcore.io.text.words import Words, find_words, plain_text, whole_numbers, without_comments
from segcore.mesh import Mesh

_KEYWORD = re.compile(rb"\s*+(ST)?(C)?(N)?(4)?(n)?OFF(\s+BINARY)?")


def read_off(data: bytes, limits: ReadLimits, with_appearance: bool = False) -> Mesh:
    """Read an OFF file, also with the prefixes ST, C and N: texture coordinates, colours and normals, the appearance.

    The prefixes give the number of words of a vertex, over any lines. If the file cannot be read so, each line is a
    vertex, and the words after its coordinates are ignored. A face ends with its line; the words after its indices are
    its colour, which is ignored.

    If a file does not end with a newline, it cannot be detected that its last number is cut short.

    Raises
    ------
    InvalidMesh, UnsupportedFormat, LimitExceeded
    """
    text = without_comments(plain_text(data))
    keyword = _KEYWORD.match(text)
    if keyword is None:
        raise InvalidMesh("The file does not begin with the word OFF: send an OFF file, or name its real format.")
    texture, color, normal, *unread = keyword.groups()
    if any(unread):
        raise UnsupportedFormat(
            "OFF files in binary or with four or more dimensions cannot be read: save it as plain OFF."
        )
    words = find_words(text, keyword.end())
    vertex_count, face_count = _counts(words, limits)
    width = 3 + (2 if texture else 0) + (4 if color else 0) + (3 if normal else 0)
    problem = InvalidMesh(f"The OFF file ends within its {vertex_count} vertices: it is cut short.")
    for first in (_vertex_words(words, vertex_count, width), _vertex_lines(words, vertex_count)):
        try:
            if first is not None:
                polygons = _polygons(words, int(first[-1]), face_count)
                appearance = None
                if with_appearance and (normal or color or texture):
                    appearance = _appearance(words, first, bool(normal), bool(color), bool(texture))
                return mesh_of_polygons(_vertices(words, first), polygons, limits, appearance)
        except InvalidMesh as error:
            problem = error
    raise problem


def _counts(words: Words, limits: ReadLimits) -> tuple[int, int]:
    if words.count < 3:
        raise InvalidMesh("The OFF file ends before the numbers of vertices, faces and edges: it is cut short.")
    counts = whole_numbers(words.numbers(0, 3))
    if counts is None or (counts < 0).any():
        raise InvalidMesh(f"Line {words.line_number(0)}: the numbers of vertices, faces and edges must be whole.")
    vertex_count, face_count, _ = counts.tolist()
    limits.check_vertices(vertex_count)
    limits.check_faces(face_count)
    if 3 * vertex_count + face_count > words.count - 3:
        raise InvalidMesh(
            f"The OFF file announces {vertex_count} vertices and {face_count} faces, but has only {words.count - 3} "
            "numbers for them: it is cut short."
        )
    return vertex_count, face_count


def _vertex_words(words: Words, count: int, width: int) -> LongArray | None:
    """(V + 1,) the first word of each vertex, then the word after the last one; None if there are too few words."""
    first = 3 + width * np.arange(count + 1, dtype=np.int64)
    return first if first[-1] <= words.count else None


def _vertex_lines(words: Words, count: int) -> LongArray | None:
    """The same if each vertex is a line, else None."""
    body = int(np.searchsorted(words.line_start, 3))
    first = words.line_start[body : body + count + 1]
    if len(first) <= count or first[0] != 3 or (np.diff(first) < 3).any():
        return None
    return first


def _vertices(words: Words, first: LongArray) -> FloatArray:
    values = words.floats(int(first[0]), int(first[-1]))
    return values[first[:-1, None] - first[0] + np.arange(3)]


def _appearance(words: Words, first: LongArray, normal: bool, color: bool, texture: bool) -> Appearance | None:
    """Normals, colours and texture coordinates, if each vertex has the same number of words."""
    widths = np.diff(first)
    if len(widths) == 0 or (widths != widths[0]).any():
        return None
    width = int(widths[0])
    table = words.floats(int(first[0]), int(first[-1])).reshape(-1, width)
    begin, end = 3 + 3 * normal, width - 2 * texture
    return appearance_or_none(
        Appearance(
            normals=unit_normals(table[:, 3:6]) if normal and begin <= end else None,
            uvs=texture_coordinates(table[:, end:]) if texture and begin <= end else None,
            colors=color_bytes(table[:, begin:end]) if color and begin <= end else None,
        )
    )


def _polygons(words: Words, first: int, count: int) -> Polygons:
    """The polygons from word ``first`` on, one on each line or each over several lines."""
    numbers = words.numbers(first, words.count)
    starts = words.line_start[np.searchsorted(words.line_start, first) :] - first
    heads, room = starts[:-1], np.diff(starts) - 1
    if len(heads) != count or heads[:1].any() or not ((numbers[heads] >= 0) & (numbers[heads] <= room)).all():
        heads = _walk(words, numbers, first, count)
    sizes = whole_numbers(numbers[heads])
    corners = None if sizes is None else whole_numbers(numbers[ragged_range(heads + 1, sizes)])
    if sizes is None or corners is None:
        raise InvalidMesh("The OFF file has a face whose numbers are not whole: a face is a count and vertex indices.")
    return Polygons(corners, sizes)


def _walk(words: Words, numbers: NDArray[Any], first: int, count: int) -> LongArray:
    """(count,) the first word of each polygon, counted from ``first``, if the polygons are not one line each."""
    next_line = np.repeat(words.line_start[1:], np.diff(words.line_start))[first:] - first
    values, after = numbers.tolist(), next_line.tolist()
    heads = np.zeros(count, dtype=np.int64)
    at = 0
    for i in range(count):
        size = values[at] if at < len(values) else math.inf
        if size > len(values) - at - 1:
            raise InvalidMesh(f"The OFF file ends at face {i} of the {count} that it announces: it is cut short.")
        if not (size >= 0 and float(size).is_integer()):
            raise InvalidMesh(f"Line {words.line_number(first + at)}: a face begins with its number of corners.")
        heads[i] = at
        at = after[at + int(size)]
    if at < len(values):
        raise InvalidMesh(
            f"Line {words.line_number(first + at)}: the OFF file goes on after the {count} faces that it announces: "
            "correct the numbers on its first lines."
        )
    return heads
