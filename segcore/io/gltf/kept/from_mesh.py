"""A glTF document of a mesh that was read from another format, with its attributes, groups and materials."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from segcore.appearance import Appearance
from segcore.arrays import BoolArray, IntArray, LongArray
from segcore.io.gltf.document import Document, Item
from segcore.io.gltf.kept.asset import ARRAY_BUFFER, COMPONENT_CODES, ELEMENT_ARRAY_BUFFER
from segcore.io.gltf.kept.writer import KeptDocument
from segcore.io.gltf.writer_geometry import Placement, place
from segcore.io.obj.corner_rows import CornerTable, rows_of_corners
from segcore.io.palette import linear_rgb
from segcore.mesh import Mesh

_SEMANTICS = {"uvs": "TEXCOORD_0", "normals": "NORMAL", "colors": "COLOR_0"}
_PLAIN = {
    "name": "without material",
    "doubleSided": True,  # the input may be open or inside out
    "pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 0.8},  # as the colours of parts
}
_LARGEST = 65535  # of a normalized number of 16 bits


@dataclass(frozen=True, slots=True, eq=False)
class Materials:
    """The materials of a mesh as members of a glTF document."""

    of_face: IntArray | None = None  # (F,) entry of ``entries``, -1 for none
    entries: list[Item] = field(default_factory=list)
    textures: list[Item] = field(default_factory=list)
    samplers: list[Item] = field(default_factory=list)
    pictures: list[tuple[str, str, bytes]] = field(default_factory=list)  # name, media type and data
    extensions: list[str] = field(default_factory=list)
    notes: tuple[str, ...] = ()


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
    builder = _Builder(materials)
    placement = place(replace(mesh, appearance=None))
    positions = np.concatenate([placement.positions, placement.positions[rows.extra_vertex]])
    bounds = {"min": positions.min(axis=0).tolist(), "max": positions.max(axis=0).tolist()}
    attributes = {"POSITION": builder.accessor(positions, "VEC3", **bounds)}
    for name, pick in picks.items():
        picked = np.where(rows.corner >= 0, pick.reshape(-1)[rows.corner], -1)
        attributes[_SEMANTICS[name]] = builder.attribute(name, tables[name].values, picked)
    runs = _runs(mesh, materials, list(has.values()))
    corners = rows.of_corner.reshape(-1, 3)[runs.face]
    names = mesh.appearance.group_names if mesh.appearance is not None else ()
    for k, key in enumerate(runs.keys.tolist()):
        group, material, *flags = key
        chosen = [_SEMANTICS[name] for name, flag in zip(has, flags, strict=True) if flag]
        primitive = {
            "attributes": {name: attributes[name] for name in ("POSITION", *chosen)},
            "indices": builder.indices(corners[runs.start[k] : runs.start[k + 1]]),
            "material": material if material >= 0 else builder.plain_material(),
        }
        builder.add_primitive(names[group] if group >= 0 else "", group, primitive)
    root = builder.document(placement)
    data = b"".join(builder.pieces)
    return KeptDocument(Document(root, memoryview(data), len(data)), runs.face, materials.notes)


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


@dataclass(slots=True, eq=False)
class _Builder:
    materials: Materials
    pieces: list[bytes] = field(default_factory=list)
    size: int = 0
    views: list[Item] = field(default_factory=list)
    accessors: list[Item] = field(default_factory=list)
    nodes: list[Item] = field(default_factory=list)
    meshes: list[Item] = field(default_factory=list)
    groups: dict[int, int] = field(default_factory=dict)  # the mesh of each
    plain: int | None = None

    def view(self, data: bytes, **properties: object) -> int:
        gap = -self.size % 4
        self.pieces += [b"\0" * gap, data]
        self.views.append({"buffer": 0, "byteOffset": self.size + gap, "byteLength": len(data), **properties})
        self.size += gap + len(data)
        return len(self.views) - 1

    def accessor(self, values: NDArray[Any], kind: str, target: int = ARRAY_BUFFER, **more: object) -> int:
        view = self.view(values.tobytes(), target=target)
        code = COMPONENT_CODES[values.dtype.str[1:]]
        self.accessors.append({"bufferView": view, "componentType": code, "type": kind, "count": len(values), **more})
        return len(self.accessors) - 1

    def indices(self, corners: IntArray) -> int:
        return self.accessor(corners.reshape(-1).astype("<u4"), "SCALAR", ELEMENT_ARRAY_BUFFER)

    def attribute(self, name: str, values: NDArray[Any], rows: LongArray) -> int:
        """Add an accessor with the values of rows; row -1 has a value that no face uses."""
        if name == "colors":
            linear = np.concatenate([linear_rgb(values[:, :3] / 255), values[:, 3:] / 255], axis=1)
            picked = np.append(linear, np.ones((1, 4)), axis=0)[rows]
            return self.accessor(np.round(picked * _LARGEST).astype("<u2"), "VEC4", normalized=True)
        filler = np.array([[0.0, 0.0, 1.0]]) if name == "normals" else np.zeros((1, 2))
        picked = np.append(values, filler, axis=0)[rows]
        if name == "normals":
            length = np.linalg.norm(picked, axis=1, keepdims=True)
            picked = np.divide(picked, length, out=np.tile(filler, (len(picked), 1)), where=length > 0)
        return self.accessor(picked.astype("<f4"), f"VEC{picked.shape[1]}")

    def plain_material(self) -> int:
        if self.plain is None:
            self.materials.entries.append(dict(_PLAIN))
            self.plain = len(self.materials.entries) - 1
        return self.plain

    def add_primitive(self, name: str, group: int, primitive: Item) -> None:
        if group not in self.groups:
            self.groups[group] = len(self.meshes)
            self.nodes.append({"mesh": len(self.meshes)} | ({"name": name} if name else {}))
            self.meshes.append({"primitives": []} | ({"name": name} if name else {}))
        self.meshes[self.groups[group]]["primitives"].append(primitive)

    def document(self, placement: Placement) -> Item:
        images = [
            {"name": name, "mimeType": media_type, "bufferView": self.view(data)}
            for name, media_type, data in self.materials.pictures
        ]
        top: Item = {"children": list(range(len(self.nodes)))}
        top |= placement.members
        lists = {
            "materials": self.materials.entries,
            "textures": self.materials.textures,
            "samplers": self.materials.samplers,
            "images": images,
            "extensionsUsed": self.materials.extensions,
        }
        return {
            "asset": {"version": "2.0", "generator": "Cleave"},
            "scene": 0,
            "scenes": [{"nodes": [len(self.nodes)]}],
            "nodes": [*self.nodes, top],
            "meshes": self.meshes,
            "accessors": self.accessors,
            "bufferViews": self.views,
            "buffers": [{"byteLength": self.size}],
            **{name: entries for name, entries in lists.items() if entries},
        }
