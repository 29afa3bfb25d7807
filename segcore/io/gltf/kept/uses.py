"""The uses of meshes in a glTF scene: each node or copy with the parts that its faces belong to."""

import hashlib
from dataclasses import dataclass
from itertools import groupby

from segcore.arrays import IntArray
from segcore.io.gltf.poses import Part


@dataclass(frozen=True, slots=True, eq=False)
class Use:
    """A mesh at a node, or one copy of it."""

    node: int
    mesh: int
    copy: int
    parts: dict[int, IntArray]  # the part of each face, for the primitives that have faces, by their numbers
    key: bytes  # equal for uses of a mesh with equal parts


def mesh_uses(parts: list[Part], part_of_face: IntArray) -> dict[int, list[Use]]:
    """Return the uses of all meshes by node, the copies of a node in their order.

    Parameters
    ----------
    part_of_face : (F,) the part of each face, in the order of the reader.
    """
    uses: dict[int, list[Use]] = {}
    at = 0
    for (node, copy), group in groupby(parts, lambda part: (part.instance.node, part.instance.copy)):
        divided: dict[int, IntArray] = {}
        digest = hashlib.sha256()
        for part in group:
            mesh, count = part.instance.mesh, part.primitive.face_count
            divided[part.primitive.index] = part_of_face[at : at + count]
            digest.update(divided[part.primitive.index].data)
            at += count
        uses.setdefault(node, []).append(Use(node, mesh, copy, divided, digest.digest()))
    return uses
