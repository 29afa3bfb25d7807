"""read_mesh: a mesh file of any format in FORMATS, detected by its content."""

import io
import os
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import BinaryIO

import numpy as np

from segcore.coordinates import axis_named, unit_named
from segcore.io.converting import with_coordinates
from segcore.io.file_sets import Companions, FolderCompanions, NoCompanions, model_in_archive, model_in_folder
from segcore.io.formats import FORMATS, declared_format, detect_format, is_plain_archive
from segcore.io.limits import ReadLimits
from segcore.io.source import read_source, without_utf_16
from segcore.lazy import called_later
from segcore.mesh import Mesh

_read_gltf = called_later("segcore.io.gltf.reader:read_gltf")
_READERS = {
    "off": called_later("segcore.io.off.reader:read_off"),
    "stl": called_later("segcore.io.stl.reader:read_stl"),
    "ply": called_later("segcore.io.ply.reader:read_ply"),
    "obj": called_later("segcore.io.obj.reader:read_obj"),
    "3mf": called_later("segcore.io.threemf.reader:read_3mf"),
}


def load_readers() -> None:
    """Import the readers of all formats, which are otherwise imported by the first file of each."""
    for reader in (_read_gltf, *_READERS.values()):
        reader.load()


@dataclass(frozen=True, slots=True, eq=False)
class OpenedModel:
    """A mesh file, unpacked but not parsed."""

    format: str  # a key of FORMATS
    data: bytes
    companions: Companions  # the files that belong to it

    @property
    def is_gltf(self) -> bool:
        return self.format in ("glb", "gltf")


def read_mesh(
    source: str | os.PathLike[str] | BinaryIO,
    format: str | None = None,  # noqa: A002
    *,
    limits: ReadLimits | None = None,
    appearance: bool = False,
    neighbours: bool = False,
    unit: str | None = None,
    up: str | None = None,
) -> Mesh:
    """Read a mesh file, which may be compressed with gzip, or the one mesh in a ZIP archive.

    Face i of the mesh is triangle i after the polygons of the file, in its order, are triangulated: convex ones as
    fans, concave ones by clipping ears, without new vertices;
    ``source_polygon`` is the polygon of each face if there are others than triangles. No vertex or face is dropped,
    merged or moved. The buffers of a glTF file may be members of the archive that it is in. No file but ``source`` is
    opened, unless ``neighbours`` is True.

    Parameters
    ----------
    source : a path, or a binary file, which is read to its end.
    format : a name, extension or media type of FORMATS. The content decides which reader is used; the file is refused
        if its content clearly has another format than this one or than the extension of the path.
    limits : the largest input that is read, by default ``ReadLimits()``.
    appearance : keep normals, texture coordinates, colours of vertices and names of groups for the outputs, as far as
        they can be read. Reading is faster without.
    neighbours : also read the files in the folder of a path, and below it, that the mesh file refers to; if the path is
        a folder, read the one mesh in it.
    unit : the unit of the coordinates, such as ``mm``, if the file does not name it or names a wrong one. The
        coordinates do not change; they are known to be in this unit (:class:`segcore.coordinates.Coordinates`).
    up : the axis that points up, ``y`` or ``z``, in the same way.

    Raises
    ------
    InvalidParameters
        If there is no such unit or axis.
    UnsupportedFormat
        If the format, or a feature that the file needs, cannot be read, or an archive or a folder does not have exactly
        one mesh.
    InvalidMesh
        If the file is damaged, cut short or without faces; the message has the line, the byte or the element.
    LimitExceeded
        If the mesh is larger than a limit, which the message names.
    OSError
        If a path cannot be read.
    """
    limits = limits or ReadLimits()
    unit, up = unit and unit_named(unit), up and axis_named(up)
    model = open_model(source, format, limits, neighbours=neighbours)
    return with_coordinates(mesh_of_model(model, limits, appearance=appearance), unit, up)


def open_model(
    source: str | os.PathLike[str] | BinaryIO,
    format: str | None,  # noqa: A002
    limits: ReadLimits,
    *,
    neighbours: bool,
) -> OpenedModel:
    """Return the bytes of a mesh file and its format; arguments and errors as of :func:`read_mesh`."""
    companions: Companions = NoCompanions()
    if neighbours and isinstance(source, str | os.PathLike):
        source = model_in_folder(Path(source))
        companions = FolderCompanions(source, limits)
    declared = declared_format(source, format)
    data = read_source(source, limits)
    if declared is None and is_plain_archive(data):
        model = model_in_archive(data, limits)
        declared, companions = declared_format(model.name, None), model.companions
        data = read_source(io.BytesIO(model.data), limits)
    data = without_utf_16(data)
    return OpenedModel(detect_format(data, declared), data, companions)


def mesh_of_model(model: OpenedModel, limits: ReadLimits, *, appearance: bool) -> Mesh:
    """Return the mesh of an opened file; errors as of :func:`read_mesh`."""
    reader = partial(_read_gltf, companions=model.companions) if model.is_gltf else _READERS[model.format]
    with np.errstate(all="ignore"):  # Mesh refuses numbers that overflow, as not finite
        mesh = reader(model.data, limits, appearance)
    return replace(mesh, coordinates=FORMATS[model.format].coordinates)
