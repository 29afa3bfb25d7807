"""The OBJ writer: plain meshes, and segmented ones with an object and a material for each segment."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import BinaryIO

import numpy as np

from segcore.appearance import Appearance
from segcore.arrays import IntArray
from segcore.hierarchy import Hierarchy
from segcore.io.converting import requested
from segcore.io.names import SegmentNames, comment, group_names, one_line
from segcore.io.slices import segment_slices
from segcore.io.text.rows import format_rows
from segcore.mesh import Mesh

LIBRARY = "model.mtl"  # the usual name of the file with the materials


@dataclass(frozen=True, slots=True, eq=False)
class FaceMaterials:
    """The materials of the faces of an OBJ file, and the MTL files that they are in."""

    of_face: IntArray  # (F,) index into ``names``, -1 for none
    names: Sequence[str]
    libraries: Sequence[str]


def encode_obj(mesh: Mesh) -> Iterator[bytes]:
    """An OBJ file without groups in pieces; vertices and corners are written as :func:`write_obj` does."""
    appearance = mesh.appearance or Appearance()
    yield from _vertex_lines(mesh, appearance)
    yield from _face_lines(mesh, appearance, np.arange(len(mesh.faces), dtype=np.int32))


def write_obj(
    target: BinaryIO,
    mesh: Mesh,
    hierarchy: Hierarchy,
    segments: int | None = None,
    *,
    names: SegmentNames | None = None,
    library: str = LIBRARY,
    materials: FaceMaterials | None = None,
    unit: str | None = None,
    up: str | None = None,
) -> None:
    """Write an OBJ file: all vertices in input order, then an object ``segment_k`` for each segment.

    An object has its faces in input order, so triangle t of object k is the t-th input face with label k. Its material
    has its name; :func:`segcore.io.obj.materials_writer.write_mtl` writes the file with the colours. Coordinates are
    decimal numbers that read back as the same float64 numbers. Normals, texture coordinates and the colours of vertices
    are those of the input. Comments after the name of an object list the groups of the input that its faces are in.

    Parameters
    ----------
    names : names of segments by label, in place of ``segment_k``; see :func:`segcore.io.names.group_names`.
    library : the name of the file with the materials, beside this one.
    materials : those of the input, in place of the materials of the segments.
    unit, up : convert the coordinates to this unit, such as ``mm``, and to this axis up, ``y`` or ``z``; by default
        they are those of the mesh.

    Raises
    ------
    InvalidParameters
        If ``segments`` is not in 1..max_segments, or the unit or the axis of the mesh is not known.
    """
    mesh = requested(mesh, unit, up)
    slices = segment_slices(hierarchy, segments)
    appearance = mesh.appearance or Appearance()
    target.write(b"# written by Cleave: object k, counted from 0, holds the faces with label k, in input order\n")
    for one in [library] if materials is None else materials.libraries:
        target.write(f"mtllib {one_line(one)}\n".encode())
    for lines in _vertex_lines(mesh, appearance):
        target.write(lines)
    for label, name in enumerate(group_names(names, len(slices))):
        faces = slices[label]
        target.write(f"o {name}\n".encode())
        if materials is None:
            target.write(f"usemtl {name}\n".encode())
        for of_input in appearance.groups_of(faces):
            target.write(f"# group of the input: {comment(of_input)}\n".encode())
        for material, run in [("", faces)] if materials is None else _runs(materials, faces):
            target.write(f"usemtl {one_line(material)}\n".encode() if material else b"")
            for lines in _face_lines(mesh, appearance, run):
                target.write(lines)


def _runs(materials: FaceMaterials, faces: IntArray) -> Iterator[tuple[str, IntArray]]:
    """The materials of some faces, each with the consecutive faces that have it; faces without one come first."""
    given = materials.of_face[faces]
    without = faces[given < 0]  # after a material there is no way back to none
    if len(without):
        yield "", without
    faces, given = faces[given >= 0], given[given >= 0]
    ends = np.flatnonzero(np.diff(given, append=-1))
    for begin, end in zip([0, *(ends[:-1] + 1).tolist()], (ends + 1).tolist(), strict=True) if len(faces) else ():
        yield materials.names[given[begin]], faces[begin:end]


def _vertex_lines(mesh: Mesh, appearance: Appearance) -> Iterator[bytes]:
    if appearance.colors is None:
        yield from format_rows("v %r %r %r\n", mesh.vertices)
    else:  # after the coordinates, as most programs write colours of vertices
        colors = np.round(appearance.colors[: len(mesh.vertices), :3] / 255, 4)
        yield from format_rows("v %r %r %r %r %r %r\n", mesh.vertices, colors)
    if appearance.uvs is not None:
        yield from format_rows("vt %r %r\n", appearance.uvs.astype(np.float64) * [1, -1] + [0, 1])
    if appearance.normals is not None:
        yield from format_rows("vn %r %r %r\n", appearance.normals.astype(np.float64))


def _face_lines(mesh: Mesh, appearance: Appearance, faces: IntArray) -> Iterator[bytes]:
    corner = _corner_form(appearance)
    rows = mesh.faces if appearance.corners is None else appearance.corners
    columns = [mesh.faces[faces], *[rows[faces]] * (corner.count("%d") - 1)]
    corners = np.stack(columns, axis=2).reshape(len(faces), -1) + 1
    return format_rows(f"f {corner} {corner} {corner}\n", corners)


def _corner_form(appearance: Appearance) -> str:
    match appearance.uvs is not None, appearance.normals is not None:
        case True, True:
            return "%d/%d/%d"
        case True, False:
            return "%d/%d"
        case False, True:
            return "%d//%d"
        case _:
            return "%d"
