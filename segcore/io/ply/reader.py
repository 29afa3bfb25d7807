"""The PLY reader (Stanford's polygon file format), in text and in binary of both byte orders."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from segcore.appearance import Appearance, appearance_or_none, color_bytes, texture_coordinates, unit_normals
from segcore.arrays import FloatArray, IntArray, LongArray
from segcore.errors import InvalidMesh
from segcore.io.limits import ReadLimits
from segcore.io.ply.binary_elements import BinaryBody
from segcore.io.ply.header import Element, Elements, Header, Rows, read_header
from segcore.io.ply.text_elements import read_text_elements
from segcore.io.polygons import Polygons, mesh_of_polygons, strip_faces
from segcore.io.text.words import whole_numbers
from segcore.mesh import Mesh

_VERTICES, _FACES, _STRIPS = "vertex", "face", "tristrips"
_INDICES = ("vertex_indices", "vertex_index")
_LIMITS = {_VERTICES: "vertices", _FACES: "faces"}
_UVS = (("s", "t"), ("u", "v"), ("texture_u", "texture_v"))  # from the lower left of the image
_BLOCK = 2**13  # vertices that fit into the cache of a CPU; 2**9 takes 30 % longer, up to 2**20 as long
_RESTART = -1  # ends a strip within a list of strips


def read_ply(data: bytes, limits: ReadLimits, with_appearance: bool = False) -> Mesh:
    """Read the vertices, polygons and triangle strips of a PLY file; all other elements and properties are ignored.

    The appearance is the normals (``nx``, ``ny``, ``nz``), texture coordinates (``s``, ``t``; ``u``, ``v``;
    ``texture_u``, ``texture_v``) and colours (``red``, ``green``, ``blue``, optionally ``alpha``) of the vertices.

    Each triangle of a strip counts as a polygon. In binary files, bytes after the last element are ignored.

    Raises
    ------
    InvalidMesh, UnsupportedFormat, LimitExceeded
    """
    header = read_header(data)
    read = _read_elements(data, header, limits)
    rows = read.elements
    if _VERTICES not in rows:
        raise InvalidMesh("The PLY file has no element 'vertex'.")
    vertices = _vertices(rows[_VERTICES])
    parts = [_polygons(name, rows[name]) for name in rows if name in (_FACES, _STRIPS)]
    vertex = next(element for element in header.elements if element.name == _VERTICES)
    appearance = _appearance(rows[_VERTICES], vertex) if with_appearance else None
    return mesh_of_polygons(vertices, _joined(parts), limits, appearance, notes=read.notes)


def _read_elements(data: bytes, header: Header, limits: ReadLimits) -> Elements:
    for element in header.elements:
        if element.name in _LIMITS:
            limits.check(f"max_{_LIMITS[element.name]}", element.count, _LIMITS[element.name])
    if not header.byte_order:
        return read_text_elements(data, header)
    body = BinaryBody(data, header.size, header.byte_order)
    return Elements({element.name: body.read(element) for element in header.elements})


def _vertices(rows: Rows) -> FloatArray:
    missing = [axis for axis in "xyz" if axis not in rows.numbers]
    if missing:
        raise InvalidMesh(f"The element 'vertex' of the PLY file has no property {missing[0]!r}.")
    vertices = np.empty((len(rows.numbers["x"]), 3))
    for first in range(0, len(vertices), _BLOCK):
        block = slice(first, first + _BLOCK)
        for i, axis in enumerate("xyz"):
            vertices[block, i] = rows.numbers[axis][block]
    return vertices


def _appearance(rows: Rows, element: Element) -> Appearance | None:
    normals, colors = _columns(rows, "nx", "ny", "nz"), _typed_columns(rows, element, "red", "green", "blue", "alpha")
    colors = _typed_columns(rows, element, "red", "green", "blue") if colors is None else colors
    uvs = next((found for names in _UVS if (found := _columns(rows, *names)) is not None), None)
    return appearance_or_none(
        Appearance(
            normals=None if normals is None else unit_normals(normals),
            uvs=None if uvs is None else texture_coordinates(uvs * [1, -1] + [0, 1]),
            colors=None if colors is None else color_bytes(colors),
        )
    )


def _columns(rows: Rows, *names: str) -> NDArray[Any] | None:
    """(V, N) the properties with these names, or None if one is missing."""
    columns = [rows.numbers[name] for name in names if name in rows.numbers]
    return np.stack(columns, axis=1) if len(columns) == len(names) else None


def _typed_columns(rows: Rows, element: Element, *names: str) -> NDArray[Any] | None:
    """The same in the types of the header if the values have them; text may be read in another type."""
    columns = _columns(rows, *names)
    if columns is None:
        return None
    types = {entry.name: entry.type for entry in element.properties}
    typed = columns.astype(np.result_type(*(types[name] for name in names)))
    return typed if typed.dtype.kind == "f" or (typed == columns).all() else columns


def _polygons(name: str, rows: Rows) -> Polygons:
    lists = next((rows.lists[key] for key in _INDICES if key in rows.lists), None)
    if lists is None:
        raise InvalidMesh(f"The element {name!r} of the PLY file has no list 'vertex_indices'.")
    corners = lists.values if lists.values.dtype == np.int32 else whole_numbers(lists.values)
    if corners is None:
        raise InvalidMesh(f"The element {name!r} of the PLY file has a vertex index that is not a whole number.")
    return Polygons(corners, lists.sizes) if name == _FACES else _triangles_of_strips(corners, lists.sizes)


def _joined(parts: list[Polygons]) -> Polygons:
    if len(parts) == 1:
        return parts[0]
    nothing = np.zeros(0, dtype=np.int64)
    return Polygons(
        np.concatenate([nothing, *(part.corners for part in parts)]),
        np.concatenate([nothing, *(part.sizes for part in parts)]),
    )


def _triangles_of_strips(indices: LongArray | IntArray, sizes: LongArray) -> Polygons:
    starts = np.zeros(len(indices) + 1, dtype=bool)
    starts[np.cumsum(sizes) - sizes] = True
    restart = indices == _RESTART
    starts[1:] |= restart
    faces = strip_faces(indices[~restart], starts[:-1][~restart])
    return Polygons(faces.reshape(-1), np.full(len(faces), 3))
