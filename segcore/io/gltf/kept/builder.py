"""DocumentBuilder: a glTF document that is made from arrays, with one buffer."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from segcore.arrays import IntArray, LongArray
from segcore.io.gltf.document import Document, Item
from segcore.io.gltf.kept.asset import ARRAY_BUFFER, COMPONENT_CODES, ELEMENT_ARRAY_BUFFER
from segcore.io.gltf.writer_geometry import Placement
from segcore.io.palette import linear_rgb

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


@dataclass(slots=True, eq=False)
class DocumentBuilder:
    """Collects the nodes of groups; ``document`` is called last."""

    materials: Materials
    _pieces: list[bytes] = field(default_factory=list)
    _size: int = 0
    _views: list[Item] = field(default_factory=list)
    _accessors: list[Item] = field(default_factory=list)
    _nodes: list[Item] = field(default_factory=list)
    _meshes: list[Item] = field(default_factory=list)
    _groups: dict[int, int] = field(default_factory=dict)  # the mesh of each
    _plain: int | None = None

    def _view(self, data: bytes, **properties: object) -> int:
        gap = -self._size % 4
        self._pieces += [b"\0" * gap, data]
        self._views.append({"buffer": 0, "byteOffset": self._size + gap, "byteLength": len(data), **properties})
        self._size += gap + len(data)
        return len(self._views) - 1

    def positions(self, values: NDArray[np.float32]) -> int:
        """Add the positions of the vertices, (V, 3), and return their accessor."""
        return self._accessor(values, "VEC3", min=values.min(axis=0).tolist(), max=values.max(axis=0).tolist())

    def _accessor(self, values: NDArray[Any], kind: str, target: int = ARRAY_BUFFER, **more: object) -> int:
        view = self._view(values.tobytes(), target=target)
        code = COMPONENT_CODES[values.dtype.str[1:]]
        self._accessors.append({"bufferView": view, "componentType": code, "type": kind, "count": len(values), **more})
        return len(self._accessors) - 1

    def indices(self, corners: IntArray) -> int:
        """Add the corners of faces, (F, 3), and return their accessor."""
        return self._accessor(corners.reshape(-1).astype("<u4"), "SCALAR", ELEMENT_ARRAY_BUFFER)

    def attribute(self, name: str, values: NDArray[Any], rows: LongArray) -> int:
        """Add an accessor with the values of rows; row -1 has a value that no face uses."""
        if name == "colors":
            linear = np.concatenate([linear_rgb(values[:, :3] / 255), values[:, 3:] / 255], axis=1)
            picked = np.append(linear, np.ones((1, 4)), axis=0)[rows]
            return self._accessor(np.round(picked * _LARGEST).astype("<u2"), "VEC4", normalized=True)
        filler = np.array([[0.0, 0.0, 1.0]]) if name == "normals" else np.zeros((1, 2))
        picked = np.append(values, filler, axis=0)[rows]
        if name == "normals":
            length = np.linalg.norm(picked, axis=1, keepdims=True)
            picked = np.divide(picked, length, out=np.tile(filler, (len(picked), 1)), where=length > 0)
        return self._accessor(picked.astype("<f4"), f"VEC{picked.shape[1]}")

    def plain_material(self) -> int:
        """Return the material of faces without one."""
        if self._plain is None:
            self.materials.entries.append(dict(_PLAIN))
            self._plain = len(self.materials.entries) - 1
        return self._plain

    def add_primitive(self, name: str, group: int, primitive: Item) -> None:
        """Add a primitive to the node of a group, which is made if it is the first one."""
        if group not in self._groups:
            self._groups[group] = len(self._meshes)
            self._nodes.append({"mesh": len(self._meshes)} | ({"name": name} if name else {}))
            self._meshes.append({"primitives": []} | ({"name": name} if name else {}))
        self._meshes[self._groups[group]]["primitives"].append(primitive)

    def document(self, placement: Placement) -> Document:
        """Return the document, whose root node has the transform of the placement."""
        images = [
            {"name": name, "mimeType": media_type, "bufferView": self._view(data)}
            for name, media_type, data in self.materials.pictures
        ]
        top: Item = {"children": list(range(len(self._nodes)))}
        top |= placement.members
        lists = {
            "materials": self.materials.entries,
            "textures": self.materials.textures,
            "samplers": self.materials.samplers,
            "images": images,
            "extensionsUsed": self.materials.extensions,
        }
        root = {
            "asset": {"version": "2.0", "generator": "Cleave"},
            "scene": 0,
            "scenes": [{"nodes": [len(self._nodes)]}],
            "nodes": [*self._nodes, top],
            "meshes": self._meshes,
            "accessors": self._accessors,
            "bufferViews": self._views,
            "buffers": [{"byteLength": self._size}],
            **{name: entries for name, entries in lists.items() if entries},
        }
        data = b"".join(self._pieces)
        return Document(root, memoryview(data), len(data))
