"""write_mesh: a mesh without a segmentation as a file."""

import os
from collections.abc import Callable, Iterator
from pathlib import PurePath
from typing import BinaryIO, TypeAlias

from segcore.errors import UnsupportedFormat
from segcore.io.obj.writer import encode_obj
from segcore.io.off.writer import encode_off
from segcore.io.ply.writer import encode_ply
from segcore.io.stl.writer import check_coordinates, encode_stl, offset_of
from segcore.mesh import Mesh

Piece: TypeAlias = bytes | memoryview


def write_mesh(
    target: str | os.PathLike[str] | BinaryIO,
    mesh: Mesh,
    format: str | None = None,  # noqa: A002
) -> None:
    """Write a mesh as OFF, STL (binary), PLY (binary) or OBJ, its vertices and faces in their order.

    OFF, PLY and OBJ keep the coordinates exactly; STL rounds them to float32 and repeats the vertices of each face. If
    that would lose details of a mesh that is far from the origin, as on a map, an STL file is moved to the origin. Its
    header begins with ``offset``, the three numbers to add to x, y and z for the place of the mesh.
    PLY and OBJ keep the normals, texture coordinates and colours of the appearance. Use :data:`segcore.io.WRITERS` to
    write a segmentation.

    Parameters
    ----------
    target : a path, or a binary file; needs ``write`` only.
    format : ``off``, ``stl``, ``ply`` or ``obj``; by default the extension of the path.

    Raises
    ------
    UnsupportedFormat
        If the format or the extension is not one of these.
    InvalidParameters
        If the format is STL and a coordinate is outside the range of float32.
    OSError
        If a path cannot be written.
    """
    pieces = _encoder(target, format)(mesh)
    if isinstance(target, str | os.PathLike):
        with open(target, "wb") as file:
            file.writelines(pieces)
    else:
        for piece in pieces:
            target.write(piece)


def _encoder(target: str | os.PathLike[str] | BinaryIO, declared: str | None) -> Callable[[Mesh], Iterator[Piece]]:
    if declared is None and isinstance(target, str | os.PathLike):
        declared = PurePath(target).suffix
    name = (declared or "").lower().removeprefix(".")
    if name not in _ENCODERS:
        raise UnsupportedFormat(f"A mesh is written as {', '.join(_ENCODERS)}, not {declared!r}: choose one of these.")
    return _ENCODERS[name]


def _checked_stl(mesh: Mesh) -> Iterator[bytes]:
    check_coordinates(mesh)  # before the file is opened
    offset = offset_of(mesh)
    if not offset.any():
        return encode_stl(mesh.vertices, mesh.faces)
    note = f"offset {' '.join(map(repr, offset.tolist()))}, written by Cleave"
    return encode_stl(mesh.vertices - offset, mesh.faces, note.encode("ascii"))


_ENCODERS: dict[str, Callable[[Mesh], Iterator[Piece]]] = {
    "off": encode_off,
    "stl": _checked_stl,
    "ply": encode_ply,
    "obj": encode_obj,
}
