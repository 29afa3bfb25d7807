"""The glTF 2.0 reader, for GLB files and for JSON with buffers that are embedded or files beside it."""

import numpy as np

from segcore.arrays import FloatArray, IntArray, transformed
from segcore.errors import InvalidMesh
from segcore.io.file_sets import Companions
from segcore.io.gltf.accessors import Accessors
from segcore.io.gltf.appearance import gltf_appearance
from segcore.io.gltf.compression.draco import DRACO, decode_draco
from segcore.io.gltf.document import Document, Item, integer, member, read_document
from segcore.io.gltf.scene import FAN, STRIP, TRIANGLES, Instance, Primitive, mesh_instances
from segcore.io.limits import ReadLimits
from segcore.io.polygons import strip_faces
from segcore.mesh import Mesh
from segcore.structure import FileStructure, file_structure, numbered_runs


def read_gltf(
    data: bytes, limits: ReadLimits, with_appearance: bool = False, companions: Companions | None = None
) -> Mesh:
    """Read all triangles of the default scene, in the coordinates of the scene.

    Face order: the nodes of the scene depth first, the primitives of each mesh, the triangles of each primitive. A mesh
    that several nodes use is repeated. Points and lines are ignored. If a transform mirrors a mesh, the orientation of
    its faces is reversed, as glTF requires, so that their outside stays outside. The appearance is NORMAL, TEXCOORD_0
    and COLOR_0, each if all primitives have it, and the names of the nodes or else of their meshes. The groups of the
    structure are the nodes.

    Parameters
    ----------
    companions : the files that may be buffers; by default none.

    Raises
    ------
    InvalidMesh, UnsupportedFormat, LimitExceeded
    """
    document = read_document(data, companions)
    accessors = Accessors(document, limits)
    instances = mesh_instances(document)
    primitives = {mesh: _primitives(document, accessors, mesh) for mesh in {at.mesh for at in instances}}
    parts = [(instance, primitive) for instance in instances for primitive in primitives[instance.mesh]]
    limits.check_faces(sum(primitive.face_count for _, primitive in parts))
    return _assemble(parts, accessors, limits, with_appearance)


def _primitives(document: Document, accessors: Accessors, mesh: int) -> list[Primitive]:
    entries = document.item("meshes", mesh).get("primitives")
    if not isinstance(entries, list) or not all(isinstance(entry, dict) for entry in entries):
        raise InvalidMesh(f"meshes[{mesh}].primitives of the glTF file must be a list of objects.")
    for i, entry in enumerate(entries):
        _decompress(document, accessors, entry, f"meshes[{mesh}].primitives[{i}]")
    described = (_primitive(entry, accessors, f"meshes[{mesh}].primitives[{i}]") for i, entry in enumerate(entries))
    return [primitive for primitive in described if primitive.mode in (TRIANGLES, STRIP, FAN)]


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
    return Primitive(where, mode, positions, indices, corners, member(entry, "attributes", where), _material(entry))


def _material(entry: Item) -> int | None:
    """The number of the material; one that is not a number is ignored, as all else of materials is."""
    material = entry.get("material")
    return material if type(material) is int else None


def _assemble(
    parts: list[tuple[Instance, Primitive]], accessors: Accessors, limits: ReadLimits, with_appearance: bool
) -> Mesh:
    """The mesh; primitives with the same positions and the same transform share their vertices."""
    blocks: dict[tuple[int, bytes], int] = {}
    vertex_count = 0
    for instance, primitive in parts:
        key = (primitive.positions, instance.transform.tobytes())
        if key not in blocks:
            blocks[key] = vertex_count
            vertex_count += accessors.count(primitive.positions)
    limits.check_vertices(vertex_count)
    vertices = [_place(accessors, positions, np.frombuffer(place)) for positions, place in blocks]
    faces = []
    for instance, primitive in parts:
        faces.append(_faces(primitive, accessors, instance))
        faces[-1] += np.int32(blocks[primitive.positions, instance.transform.tobytes()])
    return Mesh(
        np.concatenate([np.zeros((0, 3)), *vertices]) if len(vertices) != 1 else vertices[0],
        np.concatenate([np.zeros((0, 3), dtype=np.int32), *faces]) if len(faces) != 1 else faces[0],
        appearance=gltf_appearance(parts, accessors) if with_appearance else None,
        structure=_structure(parts),
    )


def _structure(parts: list[tuple[Instance, Primitive]]) -> FileStructure | None:
    sizes = [primitive.face_count for _, primitive in parts]
    groups = numbered_runs([instance.node for instance, _ in parts], sizes)
    return file_structure(groups, numbered_runs([primitive.material for _, primitive in parts], sizes))


def _place(accessors: Accessors, positions: int, transform: FloatArray) -> FloatArray:
    """(V, 3) transformed positions."""
    values = accessors.read(positions, "VEC3").astype(np.float64)
    matrix = transform.reshape(4, 4)
    return values if (matrix == np.eye(4)).all() else transformed(values, matrix[:3, :3]) + matrix[:3, 3]


def _faces(primitive: Primitive, accessors: Accessors, instance: Instance) -> IntArray:
    """(F, 3) indices into the positions of the primitive, a new array."""
    corners = _corners(primitive, accessors)
    if primitive.mode == TRIANGLES:
        faces = corners.reshape(-1, 3)
    elif primitive.mode == STRIP:
        faces = strip_faces(corners, np.arange(len(corners)) == 0).astype(np.int32)
    else:
        faces = np.stack([corners[1:-1], corners[2:], np.full(primitive.face_count, corners[0])], axis=1)
    mirrored = np.linalg.det(instance.transform[:3, :3]) < 0
    return faces[:, [0, 2, 1]] if mirrored else faces


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
