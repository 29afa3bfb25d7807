"""The materials of a segmented OBJ file, alone and in an archive with the file."""

import zipfile
from collections.abc import Mapping
from types import MappingProxyType
from typing import BinaryIO

from segcore.hierarchy import Hierarchy
from segcore.io.archive import FAST, member
from segcore.io.converting import requested
from segcore.io.names import SegmentNames, group_names
from segcore.io.obj.writer import LIBRARY, FaceMaterials, write_obj
from segcore.io.palette import SegmentColors, segment_colors
from segcore.mesh import Mesh


def write_mtl(
    target: BinaryIO,
    hierarchy: Hierarchy,
    segments: int | None = None,
    *,
    names: SegmentNames | None = None,
    part_colors: SegmentColors | None = None,
) -> None:
    """Write the MTL file of :func:`segcore.io.obj.writer.write_obj`: a material with the colour of each segment.

    Colours are in sRGB, as most programs read them.

    Parameters
    ----------
    names, part_colors : names and colours of segments by label, in place of the fixed ones.

    Raises
    ------
    InvalidParameters
        If ``segments`` is not in 1..max_segments.
    """
    count = len(hierarchy.segment_nodes(segments))
    target.write(b"# written by Cleave: the colours of the segments\n")
    for name, color in zip(group_names(names, count), segment_colors(count, part_colors).tolist(), strict=True):
        red, green, blue = (f"{channel:.4f}" for channel in color)
        target.write(f"newmtl {name}\nKd {red} {green} {blue}\nKs 0 0 0\nillum 1\n".encode())


def write_obj_archive(
    target: BinaryIO,
    mesh: Mesh,
    hierarchy: Hierarchy,
    segments: int | None = None,
    *,
    names: SegmentNames | None = None,
    part_colors: SegmentColors | None = None,
    unit: str | None = None,
    up: str | None = None,
    materials: FaceMaterials | None = None,
    files: Mapping[str, bytes] = MappingProxyType({}),
) -> None:
    """Write a ZIP archive with ``model.obj`` and ``model.mtl``.

    Parameters
    ----------
    target : a binary file; needs ``write`` and ``flush`` only.
    names, part_colors : names and colours of segments by label.
    unit, up : as of :func:`segcore.io.obj.writer.write_obj`.
    materials : those of the input, in place of the materials of the segments.
    files : further members by name, in place of ``model.mtl``, if ``materials`` is given.

    Raises
    ------
    InvalidParameters
        If ``segments`` is not in 1..max_segments, or the unit or the axis of the mesh is not known.
    """
    hierarchy.segment_nodes(segments)  # refuses a wrong level before anything is written
    mesh = requested(mesh, unit, up)
    with zipfile.ZipFile(target, "w", compresslevel=FAST) as archive:
        with archive.open(member("model.obj", compressed=True), "w", force_zip64=True) as file:
            write_obj(file, mesh, hierarchy, segments, names=names, materials=materials)  # type: ignore[arg-type]
        if materials is not None:
            for name, content in files.items():
                archive.writestr(member(name, compressed=True), content, compresslevel=FAST)
            return
        with archive.open(member(LIBRARY, compressed=True), "w") as file:
            write_mtl(file, hierarchy, segments, names=names, part_colors=part_colors)  # type: ignore[arg-type]
