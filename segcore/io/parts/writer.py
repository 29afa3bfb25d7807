"""The segments as files of their own, in one ZIP archive."""

import zipfile
from collections.abc import Callable, Iterator
from typing import BinaryIO, Literal, get_args

import numpy as np

from segcore.errors import InvalidParameters
from segcore.hierarchy import Hierarchy
from segcore.io.archive import FAST, member
from segcore.io.names import SegmentNames, file_stems, group_names
from segcore.io.parts.pieces import Part, closed_parts, segment_parts
from segcore.io.text.rows import format_rows
from segcore.mesh import Mesh, face_normals_and_areas

PartFormat = Literal["stl", "obj"]

_STL_FACE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_LARGEST = float(np.finfo(np.float32).max)
_STL_NOTE = b"binary STL, one segment, written by Cleave"
_ROWS = 2**14  # faces that are put together at a time


def write_parts(
    target: BinaryIO,
    mesh: Mesh,
    hierarchy: Hierarchy,
    segments: int | None = None,
    *,
    part_format: PartFormat = "stl",
    capped: bool = False,
    names: SegmentNames | None = None,
) -> None:
    """Write a ZIP archive with a file for every segment: ``segment_0.stl``, ``segment_1.stl``, ...

    A file holds the faces of its segment in input order. One segment after the other is put together and written.

    Parameters
    ----------
    target : a binary file; needs ``write`` and ``flush`` only.
    part_format : binary STL (float32 coordinates) or OBJ (exact ones).
    capped : close each part with caps, for printing; see :func:`segcore.io.parts.pieces.closed_parts`.
    names : what segments are called, for files such as ``segment_3_wheel.stl``.

    Raises
    ------
    InvalidParameters
        Where ``segments`` is not in 1..max_segments, there is no such format, or it cannot hold such coordinates.
    """
    if part_format not in get_args(PartFormat):
        raise InvalidParameters(f"Parts are written as {' or '.join(get_args(PartFormat))}, not {part_format!r}.")
    if part_format == "stl" and np.abs(mesh.vertices).max() > _LARGEST:
        raise InvalidParameters(f"STL files hold coordinates up to {_LARGEST:.3g}: write the parts as OBJ.")
    count = len(hierarchy.segment_nodes(segments))
    parts = (closed_parts if capped else segment_parts)(mesh, hierarchy, segments)
    stems, called = file_stems(names, count), group_names(names, count)
    with zipfile.ZipFile(target, "w", compresslevel=FAST) as archive:
        for part in parts:
            info = member(f"{stems[part.label]}.{part_format}", compressed=True)
            with archive.open(info, "w", force_zip64=True) as file:
                file.writelines(_PARTS[part_format](part, called[part.label]))


def _stl(part: Part, _: str) -> Iterator[bytes]:
    yield _STL_NOTE.ljust(80) + np.uint32(len(part.faces)).astype("<u4").tobytes()
    for first in range(0, len(part.faces), _ROWS):
        corners = part.vertices[part.faces[first : first + _ROWS]]
        table = np.zeros(len(corners), _STL_FACE)
        with np.errstate(over="ignore", invalid="ignore"):
            table["normal"] = np.nan_to_num(face_normals_and_areas(corners)[0])
        table["corners"] = corners
        yield table.tobytes()


def _obj(part: Part, name: str) -> Iterator[bytes]:
    yield f"o {name}\n".encode()
    yield from format_rows("v %r %r %r\n", part.vertices)
    yield from format_rows("f %d %d %d\n", part.faces + 1)


_PARTS: dict[str, Callable[[Part, str], Iterator[bytes]]] = {"stl": _stl, "obj": _obj}
