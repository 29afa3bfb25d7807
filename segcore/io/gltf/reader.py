"""The glTF 2.0 reader, for GLB files and for JSON with buffers that are embedded or files beside it."""

from dataclasses import dataclass, field

import numpy as np

from segcore.arrays import BoolArray, IntArray
from segcore.errors import InvalidMesh, LimitExceeded
from segcore.io.file_sets import Companions
from segcore.io.gltf.accessors import Accessors
from segcore.io.gltf.appearance import gltf_appearance
from segcore.io.gltf.compression.draco import DRACO, decode_draco
from segcore.io.gltf.document import Document, Item, integer, member, read_document
from segcore.io.gltf.instancing import copy_count, expanded
from segcore.io.gltf.poses import Part, Pose, Poses
from segcore.io.gltf.scene import FAN, INSTANCING, STRIP, TRIANGLES, Primitive, Scene, read_scene
from segcore.io.limits import ReadLimits
from segcore.io.polygons import strip_faces
from segcore.mesh import Mesh
from segcore.structure import FileStructure, file_structure, numbered_runs

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


def read_gltf(
    data: bytes, limits: ReadLimits, with_appearance: bool = False, companions: Companions | None = None
) -> Mesh:
    """Read all triangles of the default scene, in the coordinates of the scene.

    Face order: the nodes of the scene depth first, the primitives of each mesh, the triangles of each primitive. A mesh
    that several nodes use, or that has copies (EXT_mesh_gpu_instancing), is repeated. Points, lines and primitives
    without positions are left out and noted. Morph targets have their default weights, and skins the pose in which the
    joints stand; the transform of a node does not move what its skin moves. If a transform mirrors a mesh, the
    orientation of its faces is reversed, as glTF requires, so that their outside stays outside. The appearance is
    NORMAL, TEXCOORD_0 and COLOR_0, each if all primitives have it, and the names of the nodes or else of their meshes.
    The groups of the structure are the nodes, and each copy of one.

    Parameters
    ----------
    companions : the files that may be buffers; by default none.

    Raises
    ------
    InvalidMesh, UnsupportedFormat, LimitExceeded
    """
    document = read_document(data, companions)
    accessors = Accessors(document, limits)
    scene = read_scene(document)
    left_out = _LeftOut()
    meshes = dict.fromkeys(instance.mesh for instance in scene.instances)
    primitives = {mesh: _primitives(document, accessors, mesh, left_out) for mesh in meshes}
    poses = Poses(document, accessors, scene)
    parts = _parts(scene, primitives, accessors, limits, poses)
    notes = [*scene.notes, *left_out.notes()]
    if not parts and notes:
        raise InvalidMesh(f"The glTF file has no faces that can be read. {' '.join(notes)}")
    return _assemble(parts, poses, accessors, limits, with_appearance, tuple(notes))


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
            primitive = _primitive(entry, accessors, where)
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


def _primitive(entry: Item, accessors: Accessors, where: str) -> Primitive:
    mode = integer(entry, "mode", where, TRIANGLES)
    positions = integer(member(entry, "attributes", where), "POSITION", f"{where}.attributes")
    indices = integer(entry, "indices", where) if "indices" in entry else None
    corners = accessors.count(positions if indices is None else indices)
    if mode == TRIANGLES and corners % 3:
        raise InvalidMesh(f"{where} of the glTF file has {corners} corners, which is not a multiple of 3.")
    attributes = member(entry, "attributes", where)
    return Primitive(where, mode, positions, indices, corners, attributes, _material(entry), entry.get("targets"))


def _material(entry: Item) -> int | None:
    """The number of the material; one that is not a number is ignored, as all else of materials is."""
    material = entry.get("material")
    return material if type(material) is int else None


def _assemble(
    parts: list[Part],
    poses: Poses,
    accessors: Accessors,
    limits: ReadLimits,
    with_appearance: bool,
    notes: tuple[str, ...],
) -> Mesh:
    """The mesh; primitives with equal poses share their vertices."""
    starts: dict[Pose, int] = {}
    vertex_count = morphed_count = 0
    for part in parts:
        if part.pose not in starts:
            starts[part.pose] = vertex_count
            vertex_count += poses.vertex_count(part.pose)
            morphed_count += poses.vertex_count(part.pose) * poses.morph_count(part.pose)
    limits.check_vertices(vertex_count)
    limits.check("max_vertices", morphed_count, "vertices of morph targets")
    posed = {pose: poses.place(pose) for pose in starts}
    vertices = [block.positions for block in posed.values()]
    faces = []
    own: tuple[Primitive, IntArray] | None = None  # the copies of a mesh with one primitive are consecutive
    for part in parts:
        if own is None or own[0] is not part.primitive:
            own = part.primitive, _faces(part.primitive, accessors)
        outside_out = _outside_out(own[1], posed[part.pose].mirrored)
        faces.append(outside_out + np.int32(starts[part.pose]) if starts[part.pose] else outside_out)
    return Mesh(
        np.concatenate([np.zeros((0, 3)), *vertices]) if len(vertices) != 1 else vertices[0],
        np.concatenate([np.zeros((0, 3), dtype=np.int32), *faces]) if len(faces) != 1 else faces[0],
        appearance=gltf_appearance(parts, poses, accessors) if with_appearance else None,
        structure=_structure(parts),
        notes=notes,
    )


def _structure(parts: list[Part]) -> FileStructure | None:
    sizes = [part.primitive.face_count for part in parts]
    groups = numbered_runs([(part.instance.node, part.instance.copy) for part in parts], sizes)
    return file_structure(groups, numbered_runs([part.primitive.material for part in parts], sizes))


def _faces(primitive: Primitive, accessors: Accessors) -> IntArray:
    """(F, 3) indices into the positions of the primitive."""
    corners = _corners(primitive, accessors)
    if primitive.mode == TRIANGLES:
        return corners.reshape(-1, 3)
    if primitive.mode == STRIP:
        return strip_faces(corners, np.arange(len(corners)) == 0).astype(np.int32)
    return np.stack([corners[1:-1], corners[2:], np.full(primitive.face_count, corners[0])], axis=1)


def _outside_out(faces: IntArray, mirrored: BoolArray) -> IntArray:
    """(F, 3) the faces, those reversed of which most corners are mirrored; ``mirrored`` is (V,), or (1,) for all."""
    if not mirrored.any():
        return faces
    if len(mirrored) == 1:
        return faces[:, [0, 2, 1]]
    reversed_ = mirrored[faces].sum(axis=1) >= 2
    return np.where(reversed_[:, None], faces[:, [0, 2, 1]], faces)


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
