"""The PLY reader (Stanford's polygon file format), in text and in binary of both byte orders."""

import numpy as np

from segcore.arrays import FloatArray, LongArray
from segcore.errors import InvalidMesh
from segcore.io.limits import ReadLimits
from segcore.io.ply_binary import BinaryBody
from segcore.io.ply_header import Header, Rows, read_header
from segcore.io.ply_text import TextBody
from segcore.io.polygons import Polygons, mesh_of_polygons, strip_faces
from segcore.io.text import whole_numbers
from segcore.mesh import Mesh

_VERTICES, _FACES, _STRIPS = "vertex", "face", "tristrips"
_INDICES = ("vertex_indices", "vertex_index")
_LIMITS = {_VERTICES: "vertices", _FACES: "faces"}
_RESTART = -1  # ends a strip within a list of strips


def read_ply(data: bytes, limits: ReadLimits) -> Mesh:
    """Read the vertices, polygons and triangle strips of a PLY file; all other elements and properties are passed over.

    Every triangle of a strip counts as a polygon of its own. In binary, bytes after the last element are passed over.

    Raises
    ------
    InvalidMesh, UnsupportedFormat, LimitExceeded
    """
    header = read_header(data)
    rows = _read_elements(data, header, limits)
    if _VERTICES not in rows:
        raise InvalidMesh("The PLY file has no element 'vertex'.")
    vertices = _vertices(rows[_VERTICES])
    parts = [_polygons(name, rows[name]) for name in rows if name in (_FACES, _STRIPS)]
    corners = np.concatenate([np.zeros(0, dtype=np.int64), *(part.corners for part in parts)])
    sizes = np.concatenate([np.zeros(0, dtype=np.int64), *(part.sizes for part in parts)])
    return mesh_of_polygons(vertices, Polygons(corners, sizes), limits)


def _read_elements(data: bytes, header: Header, limits: ReadLimits) -> dict[str, Rows]:
    for element in header.elements:
        if element.name in _LIMITS:
            limits.check(f"max_{_LIMITS[element.name]}", element.count, _LIMITS[element.name])
    body = BinaryBody(data, header.size, header.byte_order) if header.byte_order else TextBody(data, header.size)
    rows = {element.name: body.read(element) for element in header.elements}
    body.finish()
    return rows


def _vertices(rows: Rows) -> FloatArray:
    missing = [axis for axis in "xyz" if axis not in rows.numbers]
    if missing:
        raise InvalidMesh(f"The element 'vertex' of the PLY file has no property {missing[0]!r}.")
    return np.stack([rows.numbers[axis].astype(np.float64) for axis in "xyz"], axis=1)


def _polygons(name: str, rows: Rows) -> Polygons:
    lists = next((rows.lists[key] for key in _INDICES if key in rows.lists), None)
    if lists is None:
        raise InvalidMesh(f"The element {name!r} of the PLY file has no list 'vertex_indices'.")
    corners = whole_numbers(lists.values)
    if corners is None:
        raise InvalidMesh(f"The element {name!r} of the PLY file has a vertex index that is not a whole number.")
    return Polygons(corners, lists.sizes) if name == _FACES else _triangles_of_strips(corners, lists.sizes)


def _triangles_of_strips(indices: LongArray, sizes: LongArray) -> Polygons:
    starts = np.zeros(len(indices) + 1, dtype=bool)
    starts[np.cumsum(sizes) - sizes] = True
    restart = indices == _RESTART
    starts[1:] |= restart
    faces = strip_faces(indices[~restart], starts[:-1][~restart])
    return Polygons(faces.reshape(-1), np.full(len(faces), 3))
