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

_KEYWORD = re.compile(rb"\s*+((?:ST|[CN4n])*+)OFF(\s+BINARY)?")
_COUNTS = re.compile(rb"\s*+()()(?=\d++[ \t]++\d++[ \t]*+(?:\d++[ \t]*+)?\n)")
_UNIT = 0.01  # largest deviation from the length 1 of a normal: files with two digits


def read_off(data: bytes, limits: ReadLimits, with_appearance: bool = False) -> Mesh:
    """Read an OFF file, also with the prefixes ST, C and N: texture coordinates, colours and normals, the appearance.

    The prefixes may be in any order. The word OFF may be missing, as Geomview has it, and the number of edges, too. A
    vertex is its position, its normal, its colour and its texture coordinates; the normal may also follow the colour.

    The prefixes give the number of words of a vertex, over any lines. If the file cannot be read so, each line is a
    vertex, and the words after its coordinates are ignored. A face ends with its line; the words after its indices are
    its colour, which is ignored.

    If a file does not end with a newline, it cannot be detected that its last number is cut short.

    Raises
    ------
    InvalidMesh, UnsupportedFormat, LimitExceeded
    """
    text = without_comments(plain_text(data))
    keyword = _KEYWORD.match(text) or _COUNTS.match(text)
    if keyword is None:
        raise InvalidMesh("The file does not begin with the word OFF: send an OFF file, or name its real format.")
    prefixes, binary = keyword.groups()
    if binary or b"4" in prefixes or b"n" in prefixes:
        raise UnsupportedFormat(
            "OFF files in binary or with four or more dimensions cannot be read: save it as plain OFF."
        )
    words = find_words(text, keyword.end())
    texture, color, normal = b"ST" in prefixes, b"C" in prefixes, b"N" in prefixes
    body = _words_of_counts(words)
    vertex_count, face_count = _counts(words, body, limits)
    width = 3 + 2 * texture + 4 * color + 3 * normal
    problem = InvalidMesh(f"The OFF file ends within its {vertex_count} vertices: it is cut short.")
    for first in (_vertex_words(words, body, vertex_count, width), _vertex_lines(words, body, vertex_count)):
        try:
            if first is not None:
                polygons = _polygons(words, int(first[-1]), face_count)
                appearance = None
                if with_appearance and (normal or color or texture):
                    appearance = _appearance(words, first, normal, color, texture)
                return mesh_of_polygons(_vertices(words, first), polygons, limits, appearance)
        except InvalidMesh as error:
            problem = error
    raise problem


def _words_of_counts(words: Words) -> int:
    """2 if the number of edges is missing: the first two words end a line, and the next line has more than one."""
    ends_of_lines = words.line_start[1:4].tolist()
    return 2 if 2 in ends_of_lines and 3 not in ends_of_lines else 3


def _counts(words: Words, body: int, limits: ReadLimits) -> tuple[int, int]:
    """The numbers of vertices and faces; ``body`` is the first word after them and the number of edges."""
    if words.count < body:
        raise InvalidMesh("The OFF file ends before the numbers of vertices, faces and edges: it is cut short.")
    counts = whole_numbers(words.numbers(0, body))
    if counts is None or (counts < 0).any():
        raise InvalidMesh(f"Line {words.line_number(0)}: the numbers of vertices, faces and edges must be whole.")
    vertex_count, face_count = counts[:2].tolist()
    limits.check_vertices(vertex_count)
    limits.check_faces(face_count)
    if 3 * vertex_count + face_count > words.count - body:
        raise InvalidMesh(
            f"The OFF file announces {vertex_count} vertices and {face_count} faces, but has only {words.count - body} "
            "numbers for them: it is cut short."
        )
    return vertex_count, face_count


def _vertex_words(words: Words, body: int, count: int, width: int) -> LongArray | None:
    """(V + 1,) the first word of each vertex, then the word after the last one; None if there are too few words."""
    first = body + width * np.arange(count + 1, dtype=np.int64)
    return first if first[-1] <= words.count else None


def _vertex_lines(words: Words, body: int, count: int) -> LongArray | None:
    """The same if each vertex is a line, else None."""
    line = int(np.searchsorted(words.line_start, body))
    first = words.line_start[line : line + count + 1]
    if len(first) <= count or first[0] != body or (np.diff(first) < 3).any():
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
    if width < 3 + 3 * normal + 2 * texture:
        return None
    normals_and_colors, uvs = np.split(table[:, 3:], [width - 3 - 2 * texture], axis=1)
    colors = normals_and_colors
    if normal:
        normals, colors = np.split(normals_and_colors, [3], axis=1)
        if color and _colors_precede_normals(normals_and_colors):
            colors, normals = np.split(normals_and_colors, [-3], axis=1)
    return appearance_or_none(
        Appearance(
            normals=unit_normals(normals) if normal else None,
            uvs=texture_coordinates(uvs) if texture else None,
            colors=color_bytes(colors) if color else None,
        )
    )


def _colors_precede_normals(values: FloatArray) -> bool:
    """Whether (V, K) are K - 3 colours and normals rather than normals and K - 3 colours.

    Colours must be valid; if they are in both orders, more of the normals have the length 1 in the right one.
    """
    if color_bytes(values[:, :-3]) is None:
        return False
    first, last = (
        int((np.abs(np.linalg.norm(part, axis=1) - 1) <= _UNIT).sum()) for part in (values[:, :3], values[:, -3:])
    )
    return last > first or (last == first and color_bytes(values[:, 3:]) is None)


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
