"""The triangles of a glTF scene: its primitives with faces, in the order in which the reader counts their faces."""

from dataclasses import dataclass, field

import numpy as np

from segcore.arrays import IntArray
from segcore.errors import InvalidMesh, LimitExceeded
from segcore.io.gltf.accessors import Accessors
from segcore.io.gltf.compression.draco import DRACO, decode_draco
from segcore.io.gltf.document import Document, Item, integer, member
from segcore.io.gltf.instancing import copy_count, expanded
from segcore.io.gltf.poses import Part, Poses
from segcore.io.gltf.scene import FAN, INSTANCING, STRIP, TRIANGLES, Primitive, Scene, read_scene
from segcore.io.limits import ReadLimits
from segcore.io.polygons import strip_faces

_MOST_COPIES = 100_000  # primitives of the copies of EXT_mesh_gpu_instancing; set by hand
_NAMED = 5  # primitives that a note names


@dataclass(slots=True, eq=False)
class _LeftOut:
    """The primitives that are left out, by reason."""

    primitives: dict[str, list[str]] = field(default_factory=dict)

    def add(self, reason: str, where: str) -> None:
        self.primitives.setdefault(reason, []).append(where)

    def notes(self) -> list[str]:
        return [self._note(reason, places) for reason, places in self.primitives.items()]

    def _note(self, reason: str, places: list[str]) -> str:
        more = f" and {len(places) - _NAMED} more" if len(places) > _NAMED else ""
        count = "1 primitive" if len(places) == 1 else f"{len(places)} primitives"
        verb = "is" if len(places) == 1 else "are"
        return f"{count} {reason} {verb} left out: {', '.join(places[:_NAMED])}{more}."


@dataclass(frozen=True, slots=True, eq=False)
class SceneParts:
    """The primitives of a scene that have faces, in the order of their faces, with those of every copy of a mesh."""

    parts: list[Part]
    poses: Poses
    notes: tuple[str, ...]  # on what is left out


def scene_parts(document: Document, accessors: Accessors, limits: ReadLimits) -> SceneParts:
    """Return the primitives of the default scene: nodes depth first, and the primitives of each mesh.

    Primitives that are compressed with Draco are decoded into ``accessors``.

    Raises
    ------
    InvalidMesh, UnsupportedFormat, LimitExceeded
    """
    scene = read_scene(document)
    left_out = _LeftOut()
    meshes = dict.fromkeys(instance.mesh for instance in scene.instances)
    primitives = {mesh: _primitives(document, accessors, mesh, left_out) for mesh in meshes}
    poses = Poses(document, accessors, scene)
    parts = _parts(scene, primitives, accessors, limits, poses)
    notes = [*scene.notes, *left_out.notes()]
    if not parts and notes:
        raise InvalidMesh(f"The glTF file has no faces that can be read. {' '.join(notes)}")
    return SceneParts(parts, poses, tuple(notes))


def primitive_faces(primitive: Primitive, accessors: Accessors) -> IntArray:
    """(F, 3) indices into the positions of the primitive."""
    corners = _corners(primitive, accessors)
    if primitive.mode == TRIANGLES:
        return corners.reshape(-1, 3)
    if primitive.mode == STRIP:
        return strip_faces(corners, np.arange(len(corners)) == 0).astype(np.int32)
    return np.stack([corners[1:-1], corners[2:], np.full(primitive.face_count, corners[0])], axis=1)


def _primitives(document: Document, accessors: Accessors, mesh: int, left_out: _LeftOut) -> list[Primitive]:
    """The primitives of a mesh that have faces."""
    entries = document.item("meshes", mesh).get("primitives")
    if not isinstance(entries, list) or not all(isinstance(entry, dict) for entry in entries):
        raise InvalidMesh(f"meshes[{mesh}].primitives of the glTF file must be a list of objects.")
    found = []
    for i, entry in enumerate(entries):
        where = f"meshes[{mesh}].primitives[{i}]"
        if integer(entry, "mode", where, TRIANGLES) not in (TRIANGLES, STRIP, FAN):
            left_out.add("of points or lines", where)
        elif "POSITION" not in member(entry, "attributes", where):
            left_out.add("without positions", where)
        else:
            _decompress(document, accessors, entry, where)
            primitive = _primitive(entry, accessors, where, i)
            if primitive.face_count:
                found.append(primitive)
            else:
                left_out.add("without faces", where)
    return found


def _parts(
    scene: Scene, primitives: dict[int, list[Primitive]], accessors: Accessors, limits: ReadLimits, poses: Poses
) -> list[Part]:
    """All primitives of the scene in the order of its nodes; limits are checked before copies are made."""
    faces = {mesh: sum(primitive.face_count for primitive in primitives[mesh]) for mesh in primitives}
    instances = [instance for instance in scene.instances if primitives[instance.mesh]]
    counts = [copy_count(instance, accessors) for instance in instances]
    limits.check_faces(sum(count * faces[at.mesh] for at, count in zip(instances, counts, strict=True)))
    copied = sum(count * len(primitives[at.mesh]) for at, count in zip(instances, counts, strict=True) if at.copies)
    if copied > _MOST_COPIES:
        raise LimitExceeded(f"{INSTANCING} makes {copied} copies of primitives, more than {_MOST_COPIES}: use fewer.")
    return [
        Part(copy, primitive, poses.pose(copy, primitive))
        for instance in instances
        for copy in expanded(instance, accessors)
        for primitive in primitives[instance.mesh]
    ]


def _decompress(document: Document, accessors: Accessors, entry: Item, where: str) -> None:
    """Decode a primitive that is compressed with Draco into its accessors."""
    extensions = entry.get("extensions")
    if not isinstance(extensions, dict) or DRACO not in extensions:
        return
    decoded = decode_draco(document, member(extensions, DRACO, where), where)
    attributes = member(entry, "attributes", where)
    for name, values in decoded.attributes.items():
        if name in attributes:
            accessors.supply(integer(attributes, name, where), values, where)
    accessors.supply(integer(entry, "indices", where), decoded.corners, where)


def _primitive(entry: Item, accessors: Accessors, where: str, index: int) -> Primitive:
    mode = integer(entry, "mode", where, TRIANGLES)
    positions = integer(member(entry, "attributes", where), "POSITION", f"{where}.attributes")
    indices = integer(entry, "indices", where) if "indices" in entry else None
    corners = accessors.count(positions if indices is None else indices)
    if mode == TRIANGLES and corners % 3:
        raise InvalidMesh(f"{where} of the glTF file has {corners} corners, which is not a multiple of 3.")
    attributes = member(entry, "attributes", where)
    return Primitive(
        where, index, mode, positions, indices, corners, attributes, _material(entry), entry.get("targets")
    )


def _material(entry: Item) -> int | None:
    """The number of the material; one that is not a number is ignored, as all else of materials is."""
    material = entry.get("material")
    return material if type(material) is int else None


def _corners(primitive: Primitive, accessors: Accessors) -> IntArray:
    if primitive.indices is None:
        return np.arange(primitive.corners, dtype=np.int32)
    corners = accessors.read(primitive.indices, "SCALAR")[:, 0]
    if corners.dtype.kind != "u":
        raise InvalidMesh(f"The indices of {primitive.where} of the glTF file must be unsigned whole numbers.")
    vertices = accessors.count(primitive.positions)
    if corners.size and corners.max() >= vertices:
        raise InvalidMesh(f"{primitive.where} of the glTF file has the index {corners.max()}, but {vertices} vertices.")
    return corners.astype(np.int32)
