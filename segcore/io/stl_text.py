"""The reader of STL files in text."""

import re

import numpy as np

from segcore.appearance import Appearance, group_appearance
from segcore.arrays import BoolArray, FloatArray, LongArray
from segcore.errors import InvalidMesh
from segcore.io.limits import ReadLimits
from segcore.io.polygons import Polygons, mesh_of_polygons
from segcore.io.text import Words, are_numbers, find_words, first_bad, parse_numbers, plain_text
from segcore.mesh import Mesh

# The lines of a face as nearly every program writes them, and how many words each has.
_KEYWORDS = (b"facet", b"outer", b"vertex", b"vertex", b"vertex", b"endloop", b"endfacet")
_WORDS = (5, 2, 4, 4, 4, 1, 1)
_SOLID = re.compile(rb"^[ \t]*(?:end)?solid(?!\S)[^\n]*", re.MULTILINE)
_NAME = re.compile(rb"^[ \t]*solid(?!\S)([^\n]*)", re.MULTILINE | re.IGNORECASE)
_FACET = re.compile(rb"^[ \t]*facet(?!\S)", re.MULTILINE | re.IGNORECASE)
_END = re.compile(rb"\s*+endsolid(?!\S)[^\n]*+\s*+\Z")
_FACE = re.compile(
    rb"\s*+facet(?:\s++normal(?:\s++\S++){3})?\s++outer\s++loop"
    rb"((?:\s++vertex(?:\s++\S++){3}){3,}+)\s++endloop\s++endfacet(?!\S)"
)


def read_ascii_stl(data: bytes, limits: ReadLimits, with_appearance: bool = False) -> Mesh:
    """Read an STL file in text: one or more solids; loops of more than three vertices are cut into fans.

    Raises
    ------
    InvalidMesh, LimitExceeded
    """
    text = plain_text(data).lower()
    last_line = text[text.rfind(b"\n", 0, text.rfind(b"solid") + 1) + 1 :]
    if not _END.match(last_line):
        raise InvalidMesh("The STL file does not end with 'endsolid': it is cut short.")
    vertices = _regular_vertices(find_words(text))
    if vertices is not None:
        appearance = _solids(plain_text(data), len(vertices) // 3) if with_appearance else None
        polygons = Polygons(np.arange(len(vertices)), np.full(len(vertices) // 3, 3))
        return mesh_of_polygons(vertices, polygons, limits, appearance)
    return _read_any_layout(_SOLID.sub(lambda line: b" " * len(line[0]), text), limits)


def _regular_vertices(words: Words) -> FloatArray | None:
    """(3 F, 3) where every face has the usual seven lines, else None."""
    of_face = ~_solid_lines(words)
    lines = words.line_start[:-1][of_face]
    if len(lines) == 0 or len(lines) % len(_KEYWORDS):
        return None
    lines = lines.reshape(-1, len(_KEYWORDS))
    line_words = np.diff(words.line_start)[of_face].reshape(lines.shape)
    if not (line_words == _WORDS).all() or not _has_keywords(words, lines):
        return None
    is_vertex = np.zeros(len(of_face), dtype=bool)
    is_vertex[of_face] = np.tile([keyword == b"vertex" for keyword in _KEYWORDS], len(lines))
    numbers = words.text_of_lines(is_vertex).replace(b"vertex", b"")
    try:
        return parse_numbers(numbers, 9 * len(lines), np.float64).reshape(-1, 3)
    except ValueError:
        return None


def _solid_lines(words: Words) -> BoolArray:
    """(L,): the lines that begin with ``solid`` or ``endsolid`` and may have any name after it."""
    found, at = [], words.text.find(b"solid")
    while at >= 0:
        found.append(at)
        end_of_line = words.text.find(b"\n", at)
        at = words.text.find(b"solid", end_of_line) if end_of_line >= 0 else -1
    first_words = words.line_start[:-1]
    lines = np.searchsorted(words.start[first_words], found, side="right") - 1
    is_solid = np.zeros(len(first_words), dtype=bool)
    is_solid[lines] = words.equal(first_words[lines], b"solid") | words.equal(first_words[lines], b"endsolid")
    return is_solid


def _solids(text: bytes, faces: int) -> Appearance | None:
    """The names of the solids, as groups of faces; every face has a line that begins with ``facet``."""
    solids = list(_NAME.finditer(text))
    facets = [facet.start() for facet in _FACET.finditer(text)]
    sizes = np.diff(np.searchsorted(facets, [solid.start() for solid in solids]), append=len(facets)).tolist()
    names = [solid[1].strip().decode("utf-8", "replace") for solid in solids]
    return group_appearance(names, sizes) if sum(sizes) == faces else None


def _has_keywords(words: Words, lines: LongArray) -> bool:
    first = all(words.equal(lines[:, i], keyword).all() for i, keyword in enumerate(_KEYWORDS))
    return bool(first and words.equal(lines[:, 0] + 1, b"normal").all() and words.equal(lines[:, 1] + 1, b"loop").all())


def _read_any_layout(text: bytes, limits: ReadLimits) -> Mesh:
    """The same for faces that are broken into lines in any way, with loops of any length."""
    loops, starts = [], []
    at, end = 0, len(text.rstrip())
    while at < end:
        face = _FACE.match(text, at)
        if face is None:
            raise InvalidMesh(f"Line {_line_number(text, at)}: this is no whole STL face from 'facet' to 'endfacet'.")
        loops.append(face[1])
        starts.append(at)
        at = face.end()
    sizes = np.array([loop.count(b"vertex") for loop in loops], dtype=np.int64)
    try:
        numbers = parse_numbers(b"".join(loops).replace(b"vertex", b" "), 3 * int(sizes.sum()), np.float64)
    except ValueError:
        bad = first_bad(0, len(loops), lambda low, high: _are_numeric(loops[low:high]))
        raise InvalidMesh(
            f"Line {_line_number(text, starts[bad])}: this face has a coordinate that is no number."
        ) from None
    return _mesh(numbers.reshape(-1, 3), sizes, limits)


def _mesh(vertices: FloatArray, sizes: LongArray, limits: ReadLimits) -> Mesh:
    return mesh_of_polygons(vertices, Polygons(np.arange(len(vertices)), sizes), limits)


def _are_numeric(loops: list[bytes]) -> bool:
    text = b"".join(loops)
    return are_numbers(text.replace(b"vertex", b" "), 3 * text.count(b"vertex"))


def _line_number(text: bytes, offset: int) -> int:
    """The line, counted from 1, of the first word at or after ``offset``."""
    word = re.compile(rb"\S").search(text, offset)
    return text.count(b"\n", 0, word.start() if word else offset) + 1
