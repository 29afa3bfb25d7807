"""The OBJ reader (Wavefront)."""

import re
from typing import Any

import numpy as np
from numpy.typing import NDArray

from segcore.arrays import BoolArray, FloatArray, LongArray
from segcore.errors import InvalidMesh
from segcore.io.limits import ReadLimits
from segcore.io.obj_appearance import obj_appearance
from segcore.io.polygons import Polygons, mesh_of_polygons
from segcore.io.text import Words, find_words, first_bad, parse_numbers, plain_text, without_comments
from segcore.mesh import Mesh

_CONTINUATION = re.compile(rb"\\[ \t\r]*\n")
_COORDINATE = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
_CORNER = re.compile(r"[-+]?\d+(/-?\d*){0,2}")
_SPACE, _SLASH = 32, 47
_BLOCK = 2**20  # bytes that are looked at together, so that the helper arrays stay in the cache
_IN_SUFFIX = np.isin(np.arange(256), list(b"/-0123456789"))


def read_obj(data: bytes, limits: ReadLimits, with_appearance: bool = False) -> Mesh:
    """Read the vertices and polygons of an OBJ file.

    Materials, points and lines are passed over, and no file that is named in it is ever opened. A negative index counts
    back from the last vertex before its line. The appearance is the texture coordinates and normals of the corners, the
    colours of the vertices and the names of groups and objects.

    An OBJ file does not say how long it is: one that is cut short between two lines cannot be told from a whole one.

    Raises
    ------
    InvalidMesh, LimitExceeded
    """
    text = without_comments(plain_text(data))
    if b"\\" in text:
        text = _CONTINUATION.sub(lambda end: b" " * len(end[0]), text)
    words = find_words(text)
    is_vertex, is_face = words.lines_with(b"v"), words.lines_with(b"f")
    limits.check_vertices(int(is_vertex.sum()))
    limits.check_faces(int(is_face.sum()))
    vertices = _vertices(words, is_vertex)
    polygons = _polygons(words, is_vertex, is_face)
    appearance = obj_appearance(words, is_vertex, is_face, polygons) if with_appearance else None
    return mesh_of_polygons(vertices, polygons, limits, appearance)


def _values_per_line(words: Words, lines: LongArray, what: str) -> LongArray:
    """(N,) the number of words after the keyword of each line, at least three."""
    counts = (words.line_start[lines + 1] - words.line_start[lines] - 1).astype(np.int64)
    if (counts < 3).any():
        first = words.line_start[lines[int(np.argmax(counts < 3))]]
        raise InvalidMesh(f"Line {words.line_number(int(first))}: {what} needs at least three values.")
    return counts


def _vertices(words: Words, is_vertex: BoolArray) -> FloatArray:
    lines = np.flatnonzero(is_vertex)
    counts = _values_per_line(words, lines, "a vertex")
    values = _numbers(words, lines, b"v", counts)
    first = np.cumsum(counts) - counts
    return values[first[:, None] + np.arange(3)]


def _polygons(words: Words, is_vertex: BoolArray, is_face: BoolArray) -> Polygons:
    lines = np.flatnonzero(is_face)
    sizes = _values_per_line(words, lines, "a face")
    indices = _numbers(words, lines, b"f", sizes)
    vertices_before = np.repeat(np.cumsum(is_vertex)[lines], sizes)
    corners = np.where(indices < 0, indices + vertices_before, indices - 1)
    outside = (indices == 0) | (corners < 0) | (corners >= np.count_nonzero(is_vertex))
    if outside.any():
        corner = int(np.argmax(outside))
        face = int(np.searchsorted(np.cumsum(sizes), corner, side="right"))
        line = words.line_number(int(words.line_start[lines[face]]))
        raise InvalidMesh(f"Line {line}: there is no vertex {indices[corner]} for this face.")
    return Polygons(corners, sizes)


def _numbers(words: Words, lines: LongArray, keyword: bytes, counts: LongArray) -> NDArray[Any]:
    """The numbers after the keyword on the lines, of ``7/8/9`` the first: int64 for ``f``, else float64."""

    def parsed(low: int, high: int) -> NDArray[Any]:
        return _parsed(words, lines[low:high], keyword, int(counts[low:high].sum()))

    def are_good(low: int, high: int) -> bool:
        try:
            parsed(low, high)
        except ValueError:
            return False
        return True

    try:
        return parsed(0, len(lines))
    except ValueError:
        raise _unreadable(words, int(lines[first_bad(0, len(lines), are_good)]), keyword) from None


def _parsed(words: Words, lines: LongArray, keyword: bytes, count: int) -> NDArray[Any]:
    selected = np.zeros(len(words.line_start) - 1, dtype=bool)
    selected[lines] = True
    text = words.text_of_lines(selected)
    if text.count(keyword) != len(lines):
        raise ValueError("a keyword within a number")
    text = text.replace(keyword, b" ")
    if keyword == b"v":
        return parse_numbers(text, count, np.float64)
    return parse_numbers(_without_suffixes(text) if b"/" in text else text, count, np.int64)


def _unreadable(words: Words, line: int, keyword: bytes) -> InvalidMesh:
    """What is wrong on a line with a word that is not as it should be."""
    pattern, what = (_CORNER, "a vertex index") if keyword == b"f" else (_COORDINATE, "a number")
    values = range(int(words.line_start[line]) + 1, int(words.line_start[line + 1]))
    bad = next((i for i in values if not pattern.fullmatch(words.word(i))), values[0])
    return InvalidMesh(f"Line {words.line_number(bad)}: {words.word(bad)[:40]!r} is not {what}.")


def _without_suffixes(text: bytes) -> bytes:
    """The text with spaces from the first slash of every word to its end; ValueError where they hide other things."""
    blocks, at = [], 0
    while at < len(text):
        end = text.find(b"\n", at + _BLOCK) + 1 or len(text)
        blocks.append(_block_without_suffixes(text[at:end]))
        at = end
    return b"".join(blocks)


def _block_without_suffixes(text: bytes) -> bytes:
    letters = np.frombuffer(text, np.uint8).copy()
    marks = np.flatnonzero((letters == _SLASH) | (letters <= _SPACE))
    is_slash = letters[marks] == _SLASH
    after_slash = np.concatenate([[False], is_slash[:-1]])
    change = np.zeros(len(letters), dtype=np.int8)
    change[marks[is_slash & ~after_slash]] = 1
    change[marks[~is_slash & after_slash]] = -1
    suffix = np.cumsum(change, dtype=np.int8).view(bool)
    if not _IN_SUFFIX[letters[suffix]].all():
        raise ValueError("a texture or normal index is not a number")
    letters[suffix] = _SPACE
    return letters.tobytes()
