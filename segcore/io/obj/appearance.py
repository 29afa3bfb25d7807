"""The appearance of an OBJ file; anything that cannot be read is left out, never refused."""

import numpy as np
from numpy.typing import NDArray

from segcore.appearance import Appearance, appearance_or_none, color_bytes, texture_coordinates, unit_normals
from segcore.arrays import BoolArray, FloatArray, IntArray, LongArray
from segcore.errors import InvalidMesh
from segcore.io.obj.corner_rows import CornerRows, CornerTable, rows_of_corners
from segcore.io.obj.kernels import parse_corner_picks
from segcore.io.polygons import Polygons, triangle_corners
from segcore.io.text.words import Words

_UV, _NORMAL = b"vt", b"vn"
_WIDTHS = {_UV: 2, _NORMAL: 3}  # numbers on a line
_NAMES = {_UV: "uvs", _NORMAL: "normals"}
_PLACES = {_UV: 0, _NORMAL: 1}  # column of picks: the number after the first or second slash of a corner 7/8/9


def obj_appearance(
    words: Words, is_vertex: BoolArray, is_face: BoolArray, vertices: FloatArray, polygons: Polygons
) -> Appearance | None:
    """Return the appearance of the faces that the polygons are triangulated into, or None if there is none."""
    tables = {key: table for key, width in _WIDTHS.items() if (table := _table(words, key, width)) is not None}
    picks = _picks(words, is_face, polygons, tables)
    vertex_count = int(is_vertex.sum())
    rows = rows_of_corners(polygons.corners, list(picks.values()), vertex_count)
    face_group, names = _groups(words, is_face, polygons.sizes)
    colors = _colors(words, is_vertex)
    return appearance_or_none(
        Appearance(
            normals=_normals(tables.get(_NORMAL), picks.get(_NORMAL), rows),
            uvs=_uvs(tables.get(_UV), picks.get(_UV), rows),
            colors=None if colors is None else np.vstack([colors, colors[rows.extra_vertex]]),
            extra_vertex=rows.extra_vertex,
            corners=rows.of_corner[triangle_corners(vertices, polygons)[0]] if len(rows.extra_vertex) else None,
            face_group=face_group,
            group_names=names,
        )
    )


def _table(words: Words, keyword: bytes, width: int) -> FloatArray | None:
    """(N, width) the first numbers of each line with a keyword; None if the lines do not form a table."""
    selected = words.lines_with(keyword)
    counts = np.diff(words.line_start)[selected] - 1
    if len(counts) == 0 or (counts != counts[0]).any() or counts[0] < width:
        return None
    try:
        return words.floats_at(words.line_start[:-1][selected, None] + np.arange(1, width + 1))
    except InvalidMesh:
        return None


def corner_attributes(
    words: Words, is_face: BoolArray, vertices: FloatArray, polygons: Polygons
) -> dict[str, CornerTable]:
    """Return the texture coordinates (``uvs``) and ``normals`` of the corners of the triangulated faces, by name."""
    tables = {key: table for key, width in _WIDTHS.items() if (table := _table(words, key, width)) is not None}
    picks = _corner_picks(words, is_face, polygons, tables)
    corners = triangle_corners(vertices, polygons)[0]
    known = {key: np.where((rows >= 0) & (rows < len(tables[key])), rows, -1) for key, rows in picks.items()}
    return {_NAMES[key]: CornerTable(tables[key], rows[corners]) for key, rows in known.items()}


def _picks(
    words: Words, is_face: BoolArray, polygons: Polygons, tables: dict[bytes, FloatArray]
) -> dict[bytes, LongArray]:
    """The row of each corner in each table; a table is left out if a corner has no row in it."""
    picks = _corner_picks(words, is_face, polygons, tables)
    return {key: rows for key, rows in picks.items() if ((rows >= 0) & (rows < len(tables[key]))).all()}


def _corner_picks(
    words: Words, is_face: BoolArray, polygons: Polygons, tables: dict[bytes, FloatArray]
) -> dict[bytes, LongArray]:
    """The row of each corner in each table; negative or beyond the table if it has none."""
    if not tables:
        return {}
    lines = np.flatnonzero(is_face)
    indices = np.empty((len(polygons.corners), 2), dtype=np.int64)
    parse_corner_picks(words.lines, lines, indices)
    return {
        keyword: _resolved(words, indices[:, _PLACES[keyword]], lines, polygons.sizes, keyword) for keyword in tables
    }


def _resolved(words: Words, indices: LongArray, lines: LongArray, sizes: LongArray, keyword: bytes) -> LongArray:
    """(C,) indices counted from 0, and -1 for none; negative indices count back from their line."""
    rows = indices - 1
    is_backward = indices < 0
    if is_backward.any():
        before = np.repeat(np.cumsum(words.lines_with(keyword))[lines], sizes)
        rows[is_backward] = (before + indices)[is_backward]
    return rows


def _normals(table: FloatArray | None, pick: LongArray | None, rows: CornerRows) -> NDArray[np.float32] | None:
    if table is None or pick is None:
        return None
    values = np.tile([0.0, 0.0, 1.0], (len(rows.corner), 1))  # for vertices that no face uses
    used = rows.corner >= 0
    values[used] = table[pick[rows.corner[used]]]
    return unit_normals(values)


def _uvs(table: FloatArray | None, pick: LongArray | None, rows: CornerRows) -> NDArray[np.float32] | None:
    if table is None or pick is None:
        return None
    values = np.zeros((len(rows.corner), 2))
    used = rows.corner >= 0
    values[used] = table[pick[rows.corner[used]]] * [1, -1] + [0, 1]  # OBJ counts from the lower left of the image
    return texture_coordinates(values)


def _colors(words: Words, is_vertex: BoolArray) -> NDArray[np.uint8] | None:
    """(V, 4) colours, or None unless each vertex has red, green and blue after its coordinates."""
    table = _table(words, b"v", 6)
    counts = np.diff(words.line_start)[is_vertex]
    return None if table is None or counts[0] != 7 else color_bytes(table[:, 3:])


def _groups(words: Words, is_face: BoolArray, sizes: LongArray) -> tuple[IntArray | None, tuple[str, ...]]:
    """(F,) the group or object of each face, and the names; faces before the first group have an empty name."""
    marks = np.flatnonzero(words.lines_with(b"g") | words.lines_with(b"o"))
    if len(marks) == 0:
        return None, ()
    used, of_polygon = np.unique(np.searchsorted(marks, np.flatnonzero(is_face)), return_inverse=True)
    names = [words.rest_of_line(int(marks[mark - 1])) if mark else "" for mark in used]
    entry = {name: i for i, name in enumerate(dict.fromkeys(names))}
    of_used = np.array([entry[name] for name in names], dtype=np.int32)
    return np.repeat(of_used[of_polygon], np.maximum(sizes - 2, 0)), tuple(entry)
