"""The STL reader, binary and in text."""

import struct
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from segcore.errors import InvalidMesh
from segcore.io.formats import is_ascii_stl
from segcore.io.limits import ReadLimits
from segcore.io.stl.kernels import walk_faces
from segcore.io.stl.text_reader import read_ascii_stl
from segcore.mesh import Mesh, face_normals_and_areas

HEADER = 84  # bytes: 80 for anything, 4 for the number of faces
_COUNT = 4  # bytes of the number of faces
FACE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_Table: TypeAlias = NDArray[Any]  # of FACE
_NO_COUNTS = (0, 2**32 - 1)  # what programs write that do not know the number of faces yet
_LARGEST, _SMALLEST = 1e18, 1e-30  # coordinates in files of the wrong size
_TINY_SHARE = 0.02  # of the coordinates may be smaller than that, as rounding leaves them
_AGREE = 0.9  # cosine
_ROOM = 100.0  # extents of the announced faces, within which faces beyond the number are taken for faces


def read_stl(data: bytes, limits: ReadLimits, with_appearance: bool = False) -> Mesh:
    """Read an STL file; face i has the vertices 3 i, 3 i + 1 and 3 i + 2, because the format does not join faces.

    Bytes after the faces that a binary file announces are ignored. If it announces none, or as many as the field can
    hold, or fewer than there are, its size decides, if it fits whole faces. Bytes after each face that its attribute
    announces are ignored if the size of the file is that of faces with such bytes. The appearance is the names of the
    solids of a file in text.

    Raises
    ------
    InvalidMesh, LimitExceeded
    """
    return read_ascii_stl(data, limits, with_appearance) if is_ascii_stl(data) else _read_binary(data, limits)


def _read_binary(data: bytes, limits: ReadLimits) -> Mesh:
    if len(data) < HEADER:
        raise InvalidMesh(f"The STL file ends within its header of {HEADER} bytes: it is cut short.")
    (announced,) = struct.unpack_from("<I", data, HEADER - _COUNT)
    size = HEADER + announced * FACE.itemsize
    if len(data) == size:
        return _mesh(_table(data, announced, limits))
    if announced in _NO_COUNTS:
        return _read_without_count(data, announced, limits)
    if len(data) < size:
        named = _faces_after_short_header(data, limits)
        if named is not None:
            return _mesh(named, _wrong_count("is missing", len(named)))
        raise InvalidMesh(
            f"The STL file announces {announced} faces, which take {size} bytes, but it has {len(data)}: "
            "it is cut short or not an STL file."
        )
    with_payload = _faces_with_payload(data, announced, limits)
    if with_payload is not None:
        return _mesh(with_payload, "Bytes after the faces, which their attributes announce, were skipped.")
    there = _whole_faces(data, HEADER)
    if there > announced:
        table = _table(data, there, limits)
        if _continues(table, announced):
            return _mesh(table, _wrong_count(f"says {announced}", there))
    table = _table(data, announced, limits)
    if not _are_coordinates(table):
        raise InvalidMesh(
            f"The STL file announces {announced} faces, which take {size} bytes, but it has {len(data)}, and its "
            "numbers are not coordinates: it is damaged or has bytes between its faces. Export it again."
        )
    return _mesh(table, f"{len(data) - size} bytes after the faces were ignored.")


def _read_without_count(data: bytes, announced: int, limits: ReadLimits) -> Mesh:
    """Read a file that announces no faces, or as many as the field can hold."""
    count = _whole_faces(data, HEADER)
    if count > 0:
        table = _table(data, count, limits)
        if _are_coordinates(table) and table["corners"].any():
            return _mesh(table, _wrong_count(f"says {announced}", count))
    if announced == 0 and len(data) == HEADER:
        raise InvalidMesh("The mesh has no faces: an empty file cannot be segmented.")
    raise InvalidMesh(
        f"The STL file announces {announced} faces, but it has {len(data)} bytes, which do not fit whole faces of "
        f"{FACE.itemsize} bytes after a header of {HEADER}: it is damaged or not an STL file."
    )


def _mesh(table: _Table, note: str | None = None) -> Mesh:
    count = len(table)
    corners = np.empty((count, 3, 3))
    corners[:] = table["corners"]
    faces = np.arange(3 * count, dtype=np.int32).reshape(-1, 3)
    return Mesh(corners.reshape(-1, 3), faces, notes=() if note is None else (note,))


def _table(data: bytes, count: int, limits: ReadLimits, header: int = HEADER) -> _Table:
    limits.check_faces(count)
    limits.check_vertices(3 * count)
    return np.frombuffer(data, FACE, count, header)


def _wrong_count(said: str, count: int) -> str:
    return f"The number of faces in the header {said}; there are {count} by the size of the file."


def _whole_faces(data: bytes, header: int) -> int:
    """The number of faces after a header, 0 if the rest is not a whole number of them."""
    count, rest = divmod(len(data) - header, FACE.itemsize)
    return 0 if rest else count


def _faces_with_payload(data: bytes, count: int, limits: ReadLimits) -> _Table | None:
    """The faces if each is followed by as many bytes as its attribute says and the last ones end the file."""
    limits.check_faces(count)
    starts = np.empty(count, dtype=np.int64)
    file = np.frombuffer(data, np.uint8)
    if walk_faces(file, HEADER, FACE.itemsize, starts) != len(data):
        return None
    return file[starts[:, None] + np.arange(FACE.itemsize)].view(FACE).reshape(-1)


def _faces_after_short_header(data: bytes, limits: ReadLimits) -> _Table | None:
    """The faces of a file without the field for their number, if their normals are those of their corners."""
    count = _whole_faces(data, HEADER - _COUNT)
    if count == 0:
        return None
    table = _table(data, count, limits, HEADER - _COUNT)
    normals, areas = face_normals_and_areas(table["corners"].astype(np.float64))
    agree = (normals * table["normal"]).sum(axis=1) > _AGREE
    return table if (areas > 0).any() and agree[areas > 0].all() else None


def _are_coordinates(table: _Table) -> bool:
    """Whether the numbers of faces can be those of a mesh; bytes read at a wrong place are large or tiny."""
    values = np.abs(table["corners"])
    tiny = np.count_nonzero((values > 0) & (values < _SMALLEST))
    return bool((values <= _LARGEST).all() and tiny <= _TINY_SHARE * values.size)


def _continues(table: _Table, first: int) -> bool:
    """Whether the faces from ``first`` on are like those before: none is all zero, and all are near the others."""
    before, more = table["corners"][:first].reshape(-1, 3), table["corners"][first:].reshape(-1, 3)
    low, high = before.min(axis=0), before.max(axis=0)
    room = _ROOM * float((high - low).max())
    is_near = (more >= low - room) & (more <= high + room)
    has_numbers = (table["corners"][first:] != 0).any(axis=(1, 2)) & (_sizes(table["corners"][first:]) > 0)
    return bool(is_near.all() and has_numbers.any())


def _sizes(corners: NDArray[np.float32]) -> NDArray[np.float32]:
    """(F,) the longest side of the box of each triangle."""
    sizes: NDArray[np.float32] = np.ptp(corners, axis=1).max(axis=1)
    return sizes
