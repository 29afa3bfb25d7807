"""A glTF document of a mesh that was read from another format, with its attributes, groups and materials."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from segcore.appearance import Appearance
from segcore.arrays import BoolArray, IntArray, LongArray
from segcore.io.gltf.kept.builder import DocumentBuilder, Materials
from segcore.io.gltf.kept.writer import KeptDocument
from segcore.io.gltf.writer_geometry import place
from segcore.io.obj.corner_rows import CornerTable, rows_of_corners
from segcore.mesh import Mesh

_SEMANTICS = {"uvs": "TEXCOORD_0", "normals": "NORMAL", "colors": "COLOR_0"}


def corner_tables(mesh: Mesh) -> dict[str, CornerTable]:
    """Return the attributes of the appearance of a mesh by name."""
    look = mesh.appearance or Appearance()
    rows = mesh.faces if look.corners is None else look.corners
    return {name: CornerTable(values, rows) for name, values in look.row_arrays.items()}


def document_of_mesh(mesh: Mesh, tables: Mapping[str, CornerTable], materials: Materials) -> KeptDocument:
    """Return the document: a node for each group, with a primitive for each material and set of attributes.

    All primitives share their accessors. An attribute stays with the faces all of whose corners have it.

    Parameters
    ----------
    tables : ``uvs`` (counted from the upper left of the image), ``normals`` and ``colors`` (sRGB bytes).
    """
    has = {name: _are_complete(name, table) for name, table in tables.items()}
    picks = {name: np.where(has[name][:, None], table.rows, -1).astype(np.int64) for name, table in tables.items()}
    rows = rows_of_corners(mesh.faces.reshape(-1), [pick.reshape(-1) for pick in picks.values()], len(mesh.vertices))
    builder = DocumentBuilder(materials)
    placement = place(replace(mesh, appearance=None))
    positions = np.vstack([placement.positions, placement.positions[rows.extra_vertex]])
    attributes = {"POSITION": builder.positions(positions)}
    for name, pick in picks.items():
        picked = np.where(rows.corner >= 0, pick.reshape(-1)[rows.corner], -1)
        attributes[_SEMANTICS[name]] = builder.attribute(name, tables[name].values, picked)
    runs = _runs(mesh, materials, list(has.values()))
    _add_primitives(builder, mesh, runs, rows.of_corner.reshape(-1, 3)[runs.face], attributes)
    return KeptDocument(builder.document(placement), runs.face, materials.notes)


@dataclass(frozen=True, slots=True, eq=False)
class _Runs:
    """Faces with equal groups, materials and sets of attributes."""

    face: IntArray  # (F,)
    start: LongArray  # (K + 1,) run k has face[start[k]:start[k + 1]]
    keys: IntArray  # (K, *) group, material, and whether there is each attribute


def _runs(mesh: Mesh, materials: Materials, has: list[BoolArray]) -> _Runs:
    """The runs in the order of their groups and materials, with the faces of each in their order."""
    nothing = np.full(len(mesh.faces), -1, dtype=np.int32)
    group = mesh.appearance.face_group if mesh.appearance is not None else None
    columns = [nothing if column is None else column for column in (group, materials.of_face)] + has
    order = np.lexsort(columns[::-1]).astype(np.int32)
    keys = np.stack([column[order].astype(np.int32) for column in columns], axis=1)
    begins = np.flatnonzero(np.append(True, (keys[1:] != keys[:-1]).any(axis=1)))
    return _Runs(order, np.append(begins, len(order)), keys[begins])


def _are_complete(name: str, table: CornerTable) -> BoolArray:
    """(F,) whether all corners of a face have a usable value."""
    values = table.values.astype(np.float32)
    usable: BoolArray = np.logical_and.reduce(np.isfinite(values), axis=1)
    if name == "normals":
        usable = usable & (np.linalg.norm(values, axis=1) > math.sqrt(np.finfo(np.float32).tiny))
    known = np.append(usable, False)  # of row -1
    complete: BoolArray = np.logical_and.reduce(known[table.rows], axis=1)
    return complete


def _add_primitives(
    builder: DocumentBuilder, mesh: Mesh, runs: _Runs, corners: IntArray, attributes: dict[str, int]
) -> None:
    """Add a primitive for each run.

    Parameters
    ----------
    corners : (F, 3) rows of the attributes, in the order of the runs.
    attributes : POSITION, then the others in the order of the keys of the runs; their accessors.
    """
    names = mesh.appearance.group_names if mesh.appearance is not None else ()
    others = [name for name in attributes if name != "POSITION"]
    for k, (group, material, *flags) in enumerate(runs.keys.tolist()):
        chosen = [name for name, flag in zip(others, flags, strict=True) if flag]
        primitive = {
            "attributes": {name: attributes[name] for name in ("POSITION", *chosen)},
            "indices": builder.indices(corners[runs.start[k] : runs.start[k + 1]]),
            "material": material if material >= 0 else builder.plain_material(),
        }
        builder.add_primitive(names[group] if group >= 0 else "", group, primitive)
