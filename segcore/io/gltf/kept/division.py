"""Divides the primitives of a glTF document by part; attributes stay, only indices are new."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from segcore.arrays import IntArray
from segcore.io.gltf.accessors import Accessors
from segcore.io.gltf.compression.draco import DRACO
from segcore.io.gltf.document import Document, Item
from segcore.io.gltf.kept.asset import KeptAsset
from segcore.io.gltf.kept.copies import separate_copies
from segcore.io.gltf.kept.marks import Marks
from segcore.io.gltf.kept.slots import reuse_slots
from segcore.io.gltf.kept.uses import Use, mesh_uses
from segcore.io.gltf.scene import Primitive
from segcore.io.gltf.triangles import SceneParts, primitive_faces
from segcore.io.slices import group

_LARGEST_SHORT = 2**16 - 2  # an index of 16 bits; the next one restarts strips


def divide(
    asset: KeptAsset,
    document: Document,
    accessors: Accessors,
    found: SceneParts,
    part_of_face: IntArray,
    marks: Marks,
    *,
    is_plain: bool = False,
) -> dict[int, list[int | None]]:
    """Divide the primitives of the scene.

    A mesh that nodes use with different parts gets an entry for each division; copies (EXT_mesh_gpu_instancing) with
    different parts become children of their node. A mesh that a node outside the scene uses as well stays as it was,
    beside its divisions.

    Parameters
    ----------
    part_of_face : (F,) the part of each face, in the order of the reader.
    is_plain : also make primitives whose faces are of one part lists of triangles with indices, without Draco.

    Returns
    -------
    The part of each primitive of the meshes of the scene; None for primitives without faces.
    """
    primitives = {(part.instance.mesh, part.primitive.index): part.primitive for part in found.parts}
    division = _Division(asset, document, accessors, marks, primitives, is_plain)
    uses = mesh_uses(found.parts, part_of_face)
    nodes = range(document.count("nodes"))
    division.untouched |= {entry.get("mesh") for n in nodes if n not in uses and (entry := document.item("nodes", n))}
    for node, copies in uses.items():
        entry = asset.root["nodes"][node]
        if len({use.key for use in copies}) == 1:
            entry["mesh"] = division.mesh(copies[0])
        else:
            separate_copies(asset, accessors, entry, copies, division.mesh)
    division.finish()
    return division.parts


@dataclass(slots=True, eq=False)
class _Division:
    asset: KeptAsset
    document: Document
    accessors: Accessors
    marks: Marks
    primitives: dict[tuple[int, int], Primitive]  # those with faces, by mesh and number
    is_plain: bool
    parts: dict[int, list[int | None]] = field(default_factory=dict)  # of the primitives of each mesh
    untouched: set[object] = field(default_factory=set)  # meshes whose entries must stay
    made: dict[tuple[int, bytes], int] = field(default_factory=dict)
    indices: dict[tuple[int, int, bytes], list[tuple[int, int]]] = field(default_factory=dict)
    decoded: set[int] = field(default_factory=set)  # accessors

    def mesh(self, use: Use) -> int:
        """Return the mesh with the parts of a use, which is made once."""
        key = use.mesh, use.key
        if key in self.made:
            return self.made[key]
        original = self.document.item("meshes", use.mesh)
        pieces = [piece for i in range(len(original["primitives"])) for piece in self._pieces(use, i)]
        entry = {**original, "primitives": [primitive for _, primitive in pieces]}
        if use.mesh in self.untouched:
            self.made[key] = self.asset.add("meshes", entry)
        else:
            self.asset.root["meshes"][use.mesh] = entry
            self.untouched.add(use.mesh)
            self.made[key] = use.mesh
        self.parts[self.made[key]] = [part for part, _ in pieces]
        return self.made[key]

    def finish(self) -> None:
        """Remove the data of indices that no primitive uses any more."""
        primitives = [entry for mesh in self.asset.entries("meshes") for entry in mesh["primitives"]]
        if not any(DRACO in entry.get("extensions", {}) for entry in primitives):
            self.asset.drop_extension(DRACO)
        reuse_slots(self.asset, self.document)

    def _pieces(self, use: Use, index: int) -> list[tuple[int | None, Item]]:
        """The primitives that one is divided into, and their parts: itself if its faces are all of one part."""
        primitive: Item = self.document.item("meshes", use.mesh)["primitives"][index]
        if index not in use.parts:
            return [(None, primitive)]
        parts = use.parts[index]
        if not self.is_plain and (parts == parts[0]).all():
            return [(int(parts[0]), self.marks.marked(primitive, int(parts[0])))]
        entry = {name: value for name, value in primitive.items() if name != "mode"}
        if DRACO in entry.get("extensions", {}):
            entry = self._without_draco(entry)
        return [
            (part, self.marks.marked({**entry, "indices": accessor}, part))
            for part, accessor in self._indices_of(use, index, parts)
        ]

    def _indices_of(self, use: Use, index: int, parts: IntArray) -> list[tuple[int, int]]:
        """Each part of a primitive with its accessor of indices."""
        key = use.mesh, index, parts.tobytes()
        if key not in self.indices:
            faces = primitive_faces(self.primitives[use.mesh, index], self.accessors)
            present, of_face = np.unique(parts, return_inverse=True)
            slices = group(of_face.astype(np.int32), len(present))
            self.indices[key] = [
                (part, self.asset.add_indices(_narrow(faces[slices[k]]))) for k, part in enumerate(present.tolist())
            ]
        return self.indices[key]

    def _without_draco(self, entry: Item) -> Item:
        """The primitive without its compression; its attributes become plain accessors."""
        extensions = dict(entry["extensions"])
        names = extensions.pop(DRACO)["attributes"]
        for name in names:
            if name in entry["attributes"]:
                self._decode(entry["attributes"][name])
        plain = {name: value for name, value in entry.items() if name != "extensions"}
        return plain | ({"extensions": extensions} if extensions else {})

    def _decode(self, accessor: int) -> None:
        if accessor in self.decoded:
            return
        self.decoded.add(accessor)
        entry = self.asset.root["accessors"][accessor]
        values = self.accessors.stored(accessor).astype(self.accessors.dtype(accessor), copy=False)
        for name in ("sparse", "byteOffset"):
            entry.pop(name, None)
        entry["bufferView"] = self.asset.add_rows(values, is_attribute=True)
        if "min" in entry or "max" in entry:  # of the numbers before they were compressed
            entry |= {"min": values.min(axis=0).tolist(), "max": values.max(axis=0).tolist()}


def _narrow(faces: IntArray) -> NDArray[np.unsignedinteger[Any]]:
    """The corners of faces as numbers of 16 bits, if they are small enough, else 32."""
    return faces.astype("<u2" if faces.max() <= _LARGEST_SHORT else "<u4")
