"""The OBJ reader (Wavefront)."""

import re
from dataclasses import dataclass

import numpy as np

from segcore.arrays import BoolArray, FloatArray, LongArray
from segcore.errors import InvalidMesh
from segcore.io.limits import ReadLimits
from segcore.io.obj.appearance import corner_attributes, obj_appearance
from segcore.io.obj.corner_rows import CornerTable
from segcore.io.obj.kernels import FaceLines, parse_face_lines, parse_vertex_lines
from segcore.io.obj.structure import obj_structure
from segcore.io.polygons import Polygons, mesh_of_polygons
from segcore.io.text.words import Words, find_words, plain_text, without_comments
from segcore.mesh import Mesh

_CONTINUATION = re.compile(rb"\\[ \t\r]*\n")
_NUMBERS = re.compile(
    rb"[ \t\v\f\r]*+(?:v|vt|vn|vp|f|fo|l|p|curv|curv2|surf|parm|trim|hole|scrv|sp|bmat|step|deg|con)[ \t\v\f\r]"
)  # the beginning of a line that goes on after a backslash
_CORNER = re.compile(r"[-+]?\d+(/-?\d*){0,2}", re.ASCII)


def read_obj(data: bytes, limits: ReadLimits, with_appearance: bool = False) -> Mesh:
    """Read the vertices and polygons of an OBJ file.

    Points, lines and faces with fewer than three corners are ignored, and no file that is named in it is opened. A
    negative index counts back from the last vertex before its line. A line of numbers continues after a backslash at
    its end; other lines do not, because names and paths may end in one. The appearance is the texture coordinates and
    normals of the corners, the colours of the vertices and the names of groups and objects. The structure is the groups
    and objects, and the names of materials.

    An OBJ file does not specify its length: a file that is cut short between two lines cannot be detected.

    Raises
    ------
    InvalidMesh, LimitExceeded
    """
    return _mesh(_parsed(data, limits), limits, with_appearance)


@dataclass(frozen=True, slots=True, eq=False)
class ObjModel:
    """A mesh with the attributes of its corners, also those that only some of them have."""

    mesh: Mesh
    corners: dict[str, CornerTable]  # ``uvs`` (N, 2), counted from the lower left of the image, and ``normals`` (N, 3)


def read_obj_model(data: bytes, limits: ReadLimits) -> ObjModel:
    """Read an OBJ file with the attributes of all corners; errors as of :func:`read_obj`."""
    parsed = _parsed(data, limits)
    corners = corner_attributes(parsed.words, parsed.is_face, parsed.vertices, parsed.polygons)
    return ObjModel(_mesh(parsed, limits, with_appearance=True), corners)


@dataclass(frozen=True, slots=True, eq=False)
class _Parsed:
    words: Words
    is_vertex: BoolArray  # (L,) of lines
    is_face: BoolArray  # (L,)
    vertices: FloatArray
    polygons: Polygons


def _parsed(data: bytes, limits: ReadLimits) -> _Parsed:
    words = find_words(_joined_lines(without_comments(plain_text(data))))
    is_vertex, is_face = words.lines_with(b"v"), words.lines_with(b"f")
    limits.check_vertices(int(is_vertex.sum()))
    limits.check_faces(int(is_face.sum()))
    return _Parsed(words, is_vertex, is_face, _vertices(words, is_vertex), _polygons(words, is_vertex, is_face))


def _mesh(parsed: _Parsed, limits: ReadLimits, with_appearance: bool) -> Mesh:
    words, vertices, polygons = parsed.words, parsed.vertices, parsed.polygons
    is_vertex, is_face = parsed.is_vertex, parsed.is_face
    appearance = obj_appearance(words, is_vertex, is_face, vertices, polygons) if with_appearance else None
    structure = obj_structure(words, is_vertex, is_face, polygons.sizes)
    return mesh_of_polygons(vertices, polygons, limits, appearance, structure)


def _joined_lines(text: bytes) -> bytes:
    """Replace backslashes at the end of lines of numbers, and the newlines after them, by spaces."""
    pieces: list[bytes | memoryview] = []
    at, next_line = 0, -1
    for end in _CONTINUATION.finditer(text) if b"\\" in text else ():
        begin = text.rfind(b"\n", 0, end.start()) + 1
        if begin == next_line or _NUMBERS.match(text, begin, end.start()):
            pieces += [memoryview(text)[at : end.start()], b" " * len(end[0])]
            at = next_line = end.end()
    return b"".join([*pieces, memoryview(text)[at:]]) if pieces else text


def _values_per_line(words: Words, lines: LongArray) -> LongArray:
    """(N,) the number of words after the keyword of each line."""
    return (words.line_start[lines + 1] - words.line_start[lines] - 1).astype(np.int64)


def _too_few(words: Words, line: int, what: str) -> InvalidMesh:
    number = words.line_number(int(words.line_start[line]))
    return InvalidMesh(f"Line {number}: {what} needs at least three values.")


def _vertices(words: Words, is_vertex: BoolArray) -> FloatArray:
    lines = np.flatnonzero(is_vertex)
    is_short = _values_per_line(words, lines) < 3
    if is_short.any():
        raise _too_few(words, int(lines[int(np.argmax(is_short))]), "a vertex")
    vertices, unread = np.empty((len(lines), 3)), np.empty(len(lines), dtype=bool)
    if parse_vertex_lines(words.lines, lines, vertices, unread):
        for i in np.flatnonzero(unread).tolist():
            first, last = words.line_start[lines[i] : lines[i] + 2].tolist()
            vertices[i] = [words.float(word) for word in range(first + 1, last)][:3]
    return vertices


def _polygons(words: Words, is_vertex: BoolArray, is_face: BoolArray) -> Polygons:
    lines = np.flatnonzero(is_face)
    sizes = _values_per_line(words, lines)
    if lines[-1:].tolist() == [len(is_face) - 1] and sizes[-1] < 3 and not words.ends_with_newline:
        raise _too_few(words, int(lines[-1]), "a face")  # the file is cut short in its last line
    before = np.cumsum(is_vertex, dtype=np.int32)[lines]
    corners = np.empty(int(sizes.sum()), dtype=np.int32)
    bad = parse_face_lines(words.lines, FaceLines(lines, before, int(np.count_nonzero(is_vertex))), corners)
    if bad >= 0:
        word, line = words.word(bad)[:40], words.line_number(bad)
        if _CORNER.fullmatch(word):
            raise InvalidMesh(f"Line {line}: there is no vertex {word} for this face.")
        raise InvalidMesh(f"Line {line}: {word!r} is not a vertex index.")
    return Polygons(corners, sizes)
