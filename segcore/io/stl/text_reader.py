"""The reader of STL files in text."""

import re
from typing import NamedTuple

import numpy as np

from segcore.appearance import group_appearance
from segcore.arrays import BoolArray, FloatArray, LongArray
from segcore.errors import InvalidMesh
from segcore.io.limits import ReadLimits
from segcore.io.polygons import Polygons, mesh_of_polygons
from segcore.io.text.words import Words, find_words, plain_text
from segcore.mesh import Mesh
from segcore.structure import file_structure, numbered_runs

# The lines of a face as most programs write them: the first words of each line, and its number of words.
_VERTEX = (b"vertex",)
_LINES = ((b"facet", b"normal"), (b"outer", b"loop"), _VERTEX, _VERTEX, _VERTEX, (b"endloop",), (b"endfacet",))
_WORDS = (5, 2, 4, 4, 4, 1, 1)
_VERTICES = slice(2, 5)
_SOLID = re.compile(rb"^[ \t]*(?:end)?solid(?!\S)[^\n]*", re.MULTILINE)
_MARK = re.compile(rb"[ \t]*+(?:(end[ \t_-]*+solid)|solid(?!\S))")
_FACE_LINE = re.compile(rb"^[ \t]*+(?:facet|outer|vertex|endloop|endfacet)(?!\S)", re.MULTILINE)
_OTHER_LINE = re.compile(  # the first word is no number, and no word is one that only faces have
    rb"\s*+(?!(?:facet|outer|vertex)(?!\S)|[-+.\d]|[^\n]*(?:endloop|endfacet|outer[ \t]+loop))(\S[^\n]*+)"
)
_FACE = re.compile(
    rb"\s*+facet(?:\s++normal(?:\s++\S++){3})?\s++outer\s++loop"
    rb"((?:\s++vertex(?:\s++\S++){3}){3,}+)\s++endloop\s++endfacet(?!\S)"
)


def read_ascii_stl(data: bytes, limits: ReadLimits, with_appearance: bool = False) -> Mesh:
    """Read an STL file in text: one or more solids; loops of more than three vertices are triangulated as fans.

    If there are several solids, they are the groups of the structure. Lines before, between and after faces that are
    no part of one, such as colours and comments, are skipped. The last solid must have an end.

    Raises
    ------
    InvalidMesh, LimitExceeded
    """
    plain = plain_text(data)
    lower = plain.lower()
    read = _read_regular(plain, lower, limits, with_appearance)
    if read is not None:
        return read
    text = _with_plain_ends(lower)
    read = None if text == lower else _read_regular(plain, text, limits, with_appearance)
    if read is not None:
        return read
    without_solids = _SOLID.sub(lambda line: b" " * len(line[0]), text)
    faces = _scan_faces(without_solids)
    if not faces.others:
        return _read_any_layout(without_solids, faces.sizes, limits)
    notes = (_note(plain, faces.others),)
    read = _read_regular(plain, _blanked(text, faces.others), limits, with_appearance, notes)
    return read or _read_any_layout(_blanked(without_solids, faces.others), faces.sizes, limits, notes)


def _with_plain_ends(text: bytes) -> bytes:
    """Write ``endsolid`` for each line that ends a solid, as ``end solid x`` does; no offset changes.

    Raises
    ------
    InvalidMesh
        If the last solid has no end.
    """
    pieces: list[bytes | memoryview] = []
    at = copied = end = 0
    is_open = True
    while (at := text.find(b"solid", at)) >= 0:
        begin = text.rfind(b"\n", 0, at) + 1
        newline = text.find(b"\n", at)
        at = newline if newline >= 0 else len(text)
        mark = _MARK.match(text, begin, at)
        if mark:
            is_open, end = mark[1] is None, at
        if mark and mark[1]:
            pieces += [memoryview(text)[copied:begin], b"endsolid".ljust(at - begin)]
            copied = at
    if is_open or _FACE_LINE.search(text, end):
        raise InvalidMesh("The STL file does not end with 'endsolid': it is cut short.")
    return b"".join([*pieces, memoryview(text)[copied:]])


def _read_regular(
    plain: bytes, text: bytes, limits: ReadLimits, with_appearance: bool, notes: tuple[str, ...] = ()
) -> Mesh | None:
    """Read faces that are seven lines each, before ``endsolid``; None if one is not."""
    words = find_words(text)
    if not words.equal(words.line_start[-2:-1], b"endsolid").all():
        return None
    is_solid = words.lines_with(b"solid") | words.lines_with(b"endsolid")  # the rest of the line is a name
    vertices = _regular_vertices(words, np.flatnonzero(~is_solid))
    if vertices is None:
        return None
    sizes = _sizes_of_solids(words, is_solid)
    appearance = group_appearance(_names(plain, words), sizes) if with_appearance and sizes else None
    structure = file_structure(numbered_runs(range(len(sizes)), sizes), None) if len(sizes) > 1 else None
    polygons = Polygons(np.arange(len(vertices)), np.full(len(vertices) // 3, 3))
    return mesh_of_polygons(vertices, polygons, limits, appearance, structure, notes)


def _regular_vertices(words: Words, lines: LongArray) -> FloatArray | None:
    """(3 F, 3) vertices if each face is the usual seven of ``lines``, else None."""
    if len(lines) == 0 or len(lines) % len(_LINES):
        return None
    lines = lines.reshape(-1, len(_LINES))
    if not (np.diff(words.line_start)[lines] == _WORDS).all():
        return None
    first = words.line_start[lines]
    begins = [(first[:, i] + at, word) for i, line in enumerate(_LINES) for at, word in enumerate(line)]
    if not all(words.equal(indices, word).all() for indices, word in begins):
        return None
    try:
        return words.floats_at(first[:, _VERTICES, None] + np.arange(1, 4)).reshape(-1, 3)
    except InvalidMesh:
        return None


def _sizes_of_solids(words: Words, is_solid: BoolArray) -> list[int]:
    """The number of faces of every solid; empty if there are faces before the first one."""
    solids = np.flatnonzero(words.lines_with(b"solid"))
    faces_before = np.append(np.cumsum(~is_solid)[solids], np.count_nonzero(~is_solid)) // len(_LINES)
    sizes: list[int] = np.diff(faces_before).tolist()
    return sizes if faces_before[0] == 0 else []


def _names(text: bytes, words: Words) -> list[str]:
    """The names of the solids; ``text`` has them in the original case."""
    solids = np.flatnonzero(words.lines_with(b"solid"))
    return [_name(text, int(words.start[words.line_start[line]])) for line in solids]


def _name(text: bytes, solid: int) -> str:
    """The rest of the line after the word ``solid`` at byte ``solid``."""
    end = text.find(b"\n", solid)
    return text[solid + len(b"solid") : end if end >= 0 else None].strip().decode("utf-8", "replace")


class _Scan(NamedTuple):
    """What is in a text without lines of solids."""

    sizes: list[int]  # the number of vertices of each face
    others: list[tuple[int, int]]  # first and last offset of each line that is no part of a face


def _scan_faces(text: bytes) -> _Scan:
    """Find faces that are broken into lines in any way, with loops of any length, and the lines between them."""
    found = _Scan([], [])
    at, end = 0, len(text.rstrip())
    while at < end:
        face = _FACE.match(text, at)
        other = _OTHER_LINE.match(text, at) if face is None else None
        if other and at and b"\n" not in text[at : other.start(1)]:
            other = None  # it is on the last line of a face
        if face:
            found.sizes.append(face[1].count(b"vertex"))
            at = face.end()
        elif other:
            found.others.append(other.span(1))
            at = other.end()
        else:
            raise InvalidMesh(
                f"Line {_line_number(text, at)}: this is not a whole STL face from 'facet' to 'endfacet'."
            )
    return found


def _blanked(text: bytes, spans: list[tuple[int, int]]) -> bytes:
    blank = bytearray(text)
    for begin, end in spans:
        blank[begin:end] = b" " * (end - begin)
    return bytes(blank)


def _note(text: bytes, others: list[tuple[int, int]]) -> str:
    begin, end = others[0]
    first = text[begin:end].decode("utf-8", "replace").strip()[:40]
    return (
        f"Lines that are no part of a face were skipped: {len(others)}, "
        f"the first on line {_line_number(text, begin)}: {first!r}."
    )


def _read_any_layout(text: bytes, sizes: list[int], limits: ReadLimits, notes: tuple[str, ...] = ()) -> Mesh:
    """Read the faces of a text that has nothing else."""
    words = find_words(text)
    vertices = np.flatnonzero(words.equal(np.arange(words.count), b"vertex"))
    if len(vertices) != sum(sizes) or vertices.max(initial=-4) + 3 >= words.count:
        raise InvalidMesh("The STL file has the word 'vertex' in place of a number: it is damaged.")
    coordinates = words.floats_at(vertices[:, None] + np.arange(1, 4))
    polygons = Polygons(np.arange(len(vertices)), np.array(sizes, dtype=np.int64))
    return mesh_of_polygons(coordinates, polygons, limits, notes=notes)


def _line_number(text: bytes, offset: int) -> int:
    """The line, counted from 1, of the first word at or after ``offset``."""
    word = re.compile(rb"\S").search(text, offset)
    return text.count(b"\n", 0, word.start() if word else offset) + 1
