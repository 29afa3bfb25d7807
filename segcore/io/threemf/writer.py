"""The 3MF writer: an object for each segment."""

import zipfile
from collections.abc import Iterator
from dataclasses import replace
from typing import BinaryIO

from segcore.appearance import Appearance
from segcore.arrays import FloatArray
from segcore.hierarchy import Hierarchy
from segcore.io.archive import FAST, member
from segcore.io.converting import converted
from segcore.io.names import SegmentNames, one_line, segment_names
from segcore.io.palette import SegmentColors, color_bytes
from segcore.io.parts.pieces import Part, parts_of
from segcore.io.slices import segment_slices
from segcore.io.stl.writer import offset_of
from segcore.io.text.rows import format_rows
from segcore.mesh import Mesh

CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
MODEL = "3D/3dmodel.model"
_MODEL_TYPE = "application/vnd.ms-package.3dmanufacturing-3dmodel+xml"
_RELATIONSHIPS = "http://schemas.openxmlformats.org/package/2006/relationships"
_HEAD = '<?xml version="1.0" encoding="UTF-8"?>\n'
PACKAGE = {
    "[Content_Types].xml": (
        f'{_HEAD}<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
        '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
        f'<Default Extension="model" ContentType="{_MODEL_TYPE}"/></Types>'
    ),
    "_rels/.rels": (
        f'{_HEAD}<Relationships xmlns="{_RELATIONSHIPS}"><Relationship Id="rel0" Target="/{MODEL}" '
        'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>'
    ),
}
TURN = "1 0 0 0 1 0 0 0 1"  # none: the first nine numbers of a transform
_NOT_SOLID = "not a solid: an edge does not have two faces"
_MATERIALS = 1  # the id of the colours; segment k is object k + 2


def write_3mf(
    target: BinaryIO,
    mesh: Mesh,
    hierarchy: Hierarchy,
    segments: int | None = None,
    *,
    capped: bool | None = None,
    names: SegmentNames | None = None,
    part_colors: SegmentColors | None = None,
) -> None:
    """Write a 3MF file: an assembly of the objects ``segment k``, each with its colour, in place.

    An object has the faces of its segment in input order, then its caps. Faces that repeat a vertex are left out,
    because the format does not allow them. The description of an object lists the groups of the input that its faces
    are in, and says if an edge of a closed object does not have two faces. The file is in millimetres with z up: a mesh
    with another unit or another axis up is converted, and numbers whose unit or axis is not known are written as they
    are. Coordinates are exact. If a mesh is far from the origin, so that float32 as in slicers would lose its details,
    they are relative to a point nearby, and the transform of the item moves them there.

    Parameters
    ----------
    target : a binary file; needs ``write`` only.
    capped : close each object with caps, see :func:`segcore.io.parts.pieces.closed_parts`; None for yes, because 3MF
        is a format for printing.
    names : names of segments by label, in place of ``segment k``.
    part_colors : colours of segments by label, in place of the fixed ones.

    Raises
    ------
    InvalidParameters
        If ``segments`` is not in 1..max_segments.
    """
    count = len(hierarchy.segment_nodes(segments))
    mesh = converted(mesh, "millimeter", "z")
    offset = offset_of(mesh)
    parts = parts_of(mesh, hierarchy, segments, capped is not False, offset)
    called = [quoted(name) for name in segment_names(names, count)]
    look, slices = mesh.appearance or Appearance(), segment_slices(hierarchy, segments)
    groups = [", ".join(map(one_line, look.groups_of(slices[label]))) for label in range(count)]
    with zipfile.ZipFile(target, "w", compresslevel=FAST) as archive:
        for name, text in PACKAGE.items():
            archive.writestr(member(name, compressed=True), text, compresslevel=FAST)
        with archive.open(member(MODEL, compressed=True), "w", force_zip64=True) as model:
            model.writelines(_model(parts, called, color_bytes(count, part_colors).tolist(), groups, offset))


def _description(part: Part, groups: str) -> str:
    """The XML of the description of a part; empty if there is none."""
    sentences = [f"groups of the input: {groups}"] * bool(groups) + [_NOT_SOLID] * (part.is_solid is False)
    text = f'<metadata name="Description">{_escaped("; ".join(sentences))}</metadata>'
    return f"<metadatagroup>{text}</metadatagroup>\n" if sentences else ""


def _escaped(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


def quoted(text: str) -> str:
    """An attribute value in quotation marks, or in apostrophes if it contains quotation marks and no apostrophes."""
    value = _escaped(text)
    if '"' in value and "'" not in value:
        return f"'{value}'"
    return '"' + value.replace('"', "&quot;") + '"'


def _model(
    parts: Iterator[Part], names: list[str], colors: list[list[int]], groups: list[str], offset: FloatArray
) -> Iterator[bytes]:
    materials = [
        f'<base name={name} displaycolor="#{bytes(color).hex().upper()}"/>\n'
        for name, color in zip(names, colors, strict=True)
    ]
    yield (
        f'{_HEAD}<model unit="millimeter" xml:lang="en-US" xmlns="{CORE}">\n<resources>\n'
        f'<basematerials id="{_MATERIALS}">\n{"".join(materials)}</basematerials>\n'
    ).encode()
    objects = []
    for part in parts:
        distinct = _distinct_corners(part)
        if len(distinct.faces):
            objects.append(_MATERIALS + 1 + part.label)
            yield from _object(distinct, objects[-1], names[part.label], _description(part, groups[part.label]))
    assembly = _MATERIALS + 1 + len(names)
    components = "".join(f'<component objectid="{part}"/>\n' for part in objects)
    place = f' transform="{TURN} {" ".join(map(repr, offset.tolist()))}"' if offset.any() else ""
    yield (
        f'<object id="{assembly}" type="model" name="segments">\n<components>\n{components}</components>\n</object>\n'
        f'</resources>\n<build>\n<item objectid="{assembly}"{place}/>\n</build>\n</model>\n'
    ).encode("ascii")


def _distinct_corners(part: Part) -> Part:
    a, b, c = part.faces.T
    return replace(part, faces=part.faces[(a != b) & (b != c) & (c != a)])


def _object(part: Part, number: int, name: str, description: str) -> Iterator[bytes]:
    attributes = f'id="{number}" type="model" name={name} pid="{_MATERIALS}" pindex="{part.label}"'
    yield f"<object {attributes}>\n{description}<mesh>\n<vertices>\n".encode()
    yield from format_rows('<vertex x="%r" y="%r" z="%r"/>\n', part.vertices)
    yield b"</vertices>\n<triangles>\n"
    yield from format_rows('<triangle v1="%d" v2="%d" v3="%d"/>\n', part.faces)
    yield b"</triangles>\n</mesh>\n</object>\n"
