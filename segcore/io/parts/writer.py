"""The writer of a ZIP archive with a file for each segment."""

import json
import zipfile
from collections.abc import Callable, Iterator
from typing import BinaryIO, Literal, get_args

import numpy as np

from segcore.errors import InvalidParameters
from segcore.hierarchy import Hierarchy
from segcore.io.archive import FAST, member
from segcore.io.converting import requested
from segcore.io.names import SegmentNames, file_stems, group_names, segment_names
from segcore.io.parts.pieces import Part, parts_of
from segcore.io.stl.writer import check_coordinates, encode_stl, offset_of
from segcore.io.text.rows import format_rows
from segcore.mesh import Mesh

PlainFormat = Literal["stl", "obj"]
PARTS_LIST = "parts.json"

_STL_NOTE = b"binary STL, one segment, written by Cleave"


def write_parts(
    target: BinaryIO,
    mesh: Mesh,
    hierarchy: Hierarchy,
    segments: int | None = None,
    *,
    part_format: PlainFormat = "stl",
    capped: bool | None = None,
    names: SegmentNames | None = None,
    unit: str | None = None,
    up: str | None = None,
) -> None:
    """Write a ZIP archive with a file for each segment: ``segment_0.stl``, ``segment_1.stl``, ...

    A file has the faces of its segment in input order, then its caps. If float32 would lose details of a mesh that is
    far from the origin, all parts as STL are moved by one offset. Only one segment at a time is held in memory. The
    last member, ``parts.json``, has the ``offset`` to add for the place in the input, and a list ``parts`` with
    ``file``, ``label``, ``name``, ``faces`` and ``closed``: whether each edge has exactly two faces, null for a part
    that is written as it is.

    Parameters
    ----------
    target : a binary file; needs ``write`` and ``flush`` only.
    part_format : binary STL (float32 coordinates) or OBJ (exact ones).
    capped : close each part with caps, see :func:`segcore.io.parts.pieces.closed_parts`; by default parts as STL only,
        which is a format for printing.
    names : names of segments by label, for files such as ``segment_3_wheel.stl``.
    unit, up : convert the coordinates to this unit, such as ``mm``, and to this axis up, ``y`` or ``z``; by default
        they are those of the mesh.

    Raises
    ------
    InvalidParameters
        If ``segments`` is not in 1..max_segments, or there is no such format, it cannot hold the coordinates, or the
        unit or the axis of the mesh is not known.
    """
    mesh = requested(mesh, unit, up)
    if part_format not in get_args(PlainFormat):
        raise InvalidParameters(f"Parts are written as {' or '.join(get_args(PlainFormat))}, not {part_format!r}.")
    if part_format == "stl":
        check_coordinates(mesh)
    offset = offset_of(mesh) if part_format == "stl" else np.zeros(3)
    is_closed = part_format == "stl" if capped is None else capped
    count = len(hierarchy.segment_nodes(segments))
    stems, called, titles = file_stems(names, count), group_names(names, count), segment_names(names, count)
    listed: list[dict[str, object]] = []
    with zipfile.ZipFile(target, "w", compresslevel=FAST) as archive:
        for part in parts_of(mesh, hierarchy, segments, is_closed, offset):
            info = member(f"{stems[part.label]}.{part_format}", compressed=True)
            with archive.open(info, "w", force_zip64=True) as file:
                file.writelines(_PARTS[part_format](part, called[part.label]))
            listed.append(_entry(info.filename, part, titles[part.label]))
        document = {"offset": offset.tolist(), "parts": listed}
        archive.writestr(member(PARTS_LIST), json.dumps(document, ensure_ascii=False, indent=1))


def _entry(file: str, part: Part, name: str) -> dict[str, object]:
    return {"file": file, "label": part.label, "name": name, "faces": len(part.faces), "closed": part.is_solid}


def _stl(part: Part, _: str) -> Iterator[bytes]:
    return encode_stl(part.vertices, part.faces, _STL_NOTE)


def _obj(part: Part, name: str) -> Iterator[bytes]:
    yield f"o {name}\n".encode()
    yield from format_rows("v %r %r %r\n", part.vertices)
    yield from format_rows("f %d %d %d\n", part.faces + 1)


_PARTS: dict[str, Callable[[Part, str], Iterator[bytes]]] = {"stl": _stl, "obj": _obj}
