"""The STL writer, binary."""

from collections.abc import Iterator

import numpy as np

from segcore.arrays import FloatArray, IntArray
from segcore.errors import InvalidParameters
from segcore.io.stl.reader import FACE, HEADER
from segcore.mesh import Mesh, face_normals_and_areas

_LARGEST = float(np.finfo(np.float32).max)
_FAR_OUT = 256.0  # distance from the origin, in extents of the mesh, beyond which float32 loses 1.5e-5 of the extent
_ROWS = 2**14  # faces in a piece, 0.8 MB
_NOTE = b"binary STL, written by Cleave"  # must not begin with "solid", as STL in text does


def encode_stl(vertices: FloatArray, faces: IntArray, note: bytes = _NOTE) -> Iterator[bytes]:
    """A binary STL file in pieces, its coordinates rounded to float32.

    Parameters
    ----------
    vertices : (V, 3), within the range of float32 (see :func:`check_coordinates`).
    faces : (F, 3).
    note : what the file begins with; cut off after 80 bytes.
    """
    yield note[: HEADER - 4].ljust(HEADER - 4) + np.uint32(len(faces)).astype("<u4").tobytes()
    for first in range(0, len(faces), _ROWS):
        corners = vertices[faces[first : first + _ROWS]]
        table = np.zeros(len(corners), FACE)
        with np.errstate(over="ignore", invalid="ignore"):
            table["normal"] = np.nan_to_num(face_normals_and_areas(corners)[0])
        table["corners"] = corners
        yield table.tobytes()


def check_coordinates(mesh: Mesh) -> None:
    """Raise InvalidParameters if a coordinate of a face is outside the range of float32."""
    if np.abs(mesh.bounds).max() > _LARGEST:
        raise InvalidParameters(f"STL files hold coordinates up to {_LARGEST:.3g}: choose OBJ.")


def offset_of(mesh: Mesh) -> FloatArray:
    """(3,) round numbers near the centre, from which float32 coordinates are precise; 0 if they are as they stand.

    Coordinates far from the origin, as those of maps, lose details in float32. The offset is 0 along an axis along
    which the mesh is not far out, so that no float64 coordinate changes if it is subtracted and added again.
    """
    low, high = mesh.bounds
    extent = float((high - low).max())
    is_far = np.abs([low, high]).max(axis=0) > _FAR_OUT * extent
    if extent == 0 or not is_far.any():
        return np.zeros(3)
    step = 10.0 ** np.floor(np.log10(extent))
    offset: FloatArray = np.where(is_far, np.round((0.5 * low + 0.5 * high) / step) * step, 0.0)
    return offset
