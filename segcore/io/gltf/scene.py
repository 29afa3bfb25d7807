"""The meshes of a glTF scene: their transforms, and the primitives that they consist of."""

from dataclasses import dataclass

import numpy as np

from segcore.arrays import FloatArray
from segcore.errors import InvalidMesh
from segcore.io.gltf.document import Document, Item, indices, integer, numbers

TRIANGLES, STRIP, FAN = 4, 5, 6  # modes of primitives

_IDENTITY = np.eye(4)


@dataclass(frozen=True, slots=True, eq=False)
class Instance:
    """A mesh in the scene."""

    node: int
    mesh: int
    transform: FloatArray  # (4, 4) from the mesh to the scene, for column vectors
    name: str  # of the node, else of the mesh, else empty


@dataclass(frozen=True, slots=True, eq=False)
class Primitive:
    """Triangles of a mesh."""

    where: str  # the member of the document, for messages
    mode: int
    positions: int  # accessor
    indices: int | None  # accessor
    corners: int  # the number of indices, or of positions if there are no indices
    attributes: Item  # all accessors of vertices, by semantic
    material: int | None

    @property
    def face_count(self) -> int:
        return self.corners // 3 if self.mode == TRIANGLES else max(self.corners - 2, 0)


def mesh_instances(document: Document) -> list[Instance]:
    """Return all meshes of the default scene, depth first, children in their order.

    The default scene is the one that the file names, else its first one, else all nodes that are not children. The
    transform of a node with a skin is ignored, as glTF requires, and the skin is in its rest pose.

    Raises
    ------
    InvalidMesh
        If a node is reached twice: the nodes do not form a forest.
    """
    instances = []
    reached: set[int] = set()
    waiting = [(node, _IDENTITY) for node in reversed(_roots(document))]
    while waiting:
        node, parent = waiting.pop()
        if node in reached:
            raise InvalidMesh(f"nodes[{node}] of the glTF file has two parents or is inside itself.")
        reached.add(node)
        entry, where = document.item("nodes", node), f"nodes[{node}]"
        transform = parent @ _local_transform(entry, where)
        if "mesh" in entry:
            mesh = integer(entry, "mesh", where)
            place = _IDENTITY if "skin" in entry else transform
            instances.append(Instance(node, mesh, place, _name(entry) or _name(document.item("meshes", mesh))))
        waiting.extend((child, transform) for child in reversed(indices(entry, "children", where)))
    return instances


def _name(entry: Item) -> str:
    name = entry.get("name")
    return name if isinstance(name, str) else ""


def _roots(document: Document) -> list[int]:
    if document.count("scenes"):
        scene = integer(document.root, "scene", "the top level", 0)
        return indices(document.item("scenes", scene), "nodes", f"scenes[{scene}]")
    nodes = range(document.count("nodes"))
    children = {
        child for node in nodes for child in indices(document.item("nodes", node), "children", f"nodes[{node}]")
    }
    return [node for node in nodes if node not in children]


def _local_transform(node: Item, where: str) -> FloatArray:
    if "matrix" in node:
        return np.array(numbers(node, "matrix", where, _IDENTITY.ravel().tolist())).reshape(4, 4).T
    transform = np.eye(4)
    rotation = _rotation(numbers(node, "rotation", where, [0.0, 0.0, 0.0, 1.0]), where)
    transform[:3, :3] = rotation * numbers(node, "scale", where, [1.0, 1.0, 1.0])
    transform[:3, 3] = numbers(node, "translation", where, [0.0, 0.0, 0.0])
    return transform


def _rotation(quaternion: list[float], where: str) -> FloatArray:
    """(3, 3) rotation of a quaternion (x, y, z, w), which is normalized first."""
    norm = float(np.linalg.norm(quaternion))
    if not 0 < norm < np.inf:
        raise InvalidMesh(f"{where}.rotation of the glTF file is not a rotation.")
    x, y, z, w = np.array(quaternion) / norm
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
