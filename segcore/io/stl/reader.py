"""The STL reader, binary and in text."""

import struct

import numpy as np

from segcore.errors import InvalidMesh
from segcore.io.formats import is_ascii_stl
from segcore.io.limits import ReadLimits
from segcore.io.stl.text_reader import read_ascii_stl
from segcore.mesh import Mesh

HEADER = 84  # bytes: 80 for anything, 4 for the number of faces
FACE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def read_stl(data: bytes, limits: ReadLimits, with_appearance: bool = False) -> Mesh:
    """Read an STL file; face i has the vertices 3 i, 3 i + 1 and 3 i + 2, because the format does not join faces.

    Bytes after the faces that a binary file announces are ignored. The appearance is the names of the solids of a file
    in text.

    Raises
    ------
    InvalidMesh, LimitExceeded
    """
    return read_ascii_stl(data, limits, with_appearance) if is_ascii_stl(data) else _read_binary(data, limits)


def _read_binary(data: bytes, limits: ReadLimits) -> Mesh:
    if len(data) < HEADER:
        raise InvalidMesh(f"The STL file ends within its header of {HEADER} bytes: it is cut short.")
    (count,) = struct.unpack_from("<I", data, HEADER - 4)
    limits.check_faces(count)
    limits.check_vertices(3 * count)
    if len(data) < HEADER + count * FACE.itemsize:
        raise InvalidMesh(
            f"The STL file announces {count} faces, which take {HEADER + count * FACE.itemsize} bytes, but it has "
            f"{len(data)}: it is cut short or not an STL file."
        )
    corners = np.empty((count, 3, 3))
    corners[:] = np.frombuffer(data, FACE, count, HEADER)["corners"]
    return Mesh(corners.reshape(-1, 3), np.arange(3 * count, dtype=np.int32).reshape(-1, 3))
