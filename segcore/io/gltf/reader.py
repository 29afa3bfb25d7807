"""The glTF 2.0 reader, for GLB files and for JSON with buffers that are embedded or files beside it."""

import numpy as np

from segcore.arrays import BoolArray, IntArray
from segcore.io.file_sets import Companions
from segcore.io.gltf.accessors import Accessors
from segcore.io.gltf.appearance import gltf_appearance
from segcore.io.gltf.document import read_document
from segcore.io.gltf.poses import Part, Pose
from segcore.io.gltf.scene import Primitive
from segcore.io.gltf.triangles import SceneParts, primitive_faces, scene_parts
from segcore.io.limits import ReadLimits
from segcore.mesh import Mesh
from segcore.structure import FileStructure, file_structure, numbered_runs


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
    return _assemble(scene_parts(document, accessors, limits), accessors, limits, with_appearance)


def _assemble(found: SceneParts, accessors: Accessors, limits: ReadLimits, with_appearance: bool) -> Mesh:
    """The mesh; primitives with equal poses share their vertices."""
    parts, poses = found.parts, found.poses
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
            own = part.primitive, primitive_faces(part.primitive, accessors)
        outside_out = _outside_out(own[1], posed[part.pose].mirrored)
        faces.append(outside_out + np.int32(starts[part.pose]) if starts[part.pose] else outside_out)
    return Mesh(
        np.concatenate([np.zeros((0, 3)), *vertices]) if len(vertices) != 1 else vertices[0],
        np.concatenate([np.zeros((0, 3), dtype=np.int32), *faces]) if len(faces) != 1 else faces[0],
        appearance=gltf_appearance(parts, poses, accessors) if with_appearance else None,
        structure=_structure(parts),
        notes=found.notes,
    )


def _structure(parts: list[Part]) -> FileStructure | None:
    sizes = [part.primitive.face_count for part in parts]
    groups = numbered_runs([(part.instance.node, part.instance.copy) for part in parts], sizes)
    return file_structure(groups, numbered_runs([part.primitive.material for part in parts], sizes))


def _outside_out(faces: IntArray, mirrored: BoolArray) -> IntArray:
    """(F, 3) the faces, those reversed of which most corners are mirrored; ``mirrored`` is (V,), or (1,) for all."""
    if not mirrored.any():
        return faces
    if len(mirrored) == 1:
        return faces[:, [0, 2, 1]]
    reversed_ = mirrored[faces].sum(axis=1) >= 2
    return np.where(reversed_[:, None], faces[:, [0, 2, 1]], faces)
