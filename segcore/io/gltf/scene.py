"""Where the meshes of a glTF scene stand: its nodes, one after the other, with their transforms."""

from dataclasses import dataclass

import numpy as np

from segcore.arrays import FloatArray
from segcore.errors import InvalidMesh
from segcore.io.gltf.document import Document, Item, indices, integer, numbers

_IDENTITY = np.eye(4)


@dataclass(frozen=True, slots=True, eq=False)
class Instance:
    """A mesh at a place of the scene."""

    mesh: int
    transform: FloatArray  # (4, 4) from the mesh to the scene, for column vectors
    name: str  # of the node, else of the mesh, else empty


def mesh_instances(document: Document) -> list[Instance]:
    """All meshes of the default scene, depth first, children in their order.

    The default scene is the one that the file names, else its first, else all nodes that are no children. The transform
    of a node with a skin does not count, as glTF wants it; the skin itself is left in its rest pose.

    Raises
    ------
    InvalidMesh
        Where a node is reached twice: its nodes do not form a forest.
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
            instances.append(Instance(mesh, place, _name(entry) or _name(document.item("meshes", mesh))))
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
    """(3, 3) of a quaternion (x, y, z, w), made a unit one first."""
    norm = float(np.linalg.norm(quaternion))
    if not 0 < norm < np.inf:
        raise InvalidMesh(f"{where}.rotation of the glTF file is no rotation.")
    x, y, z, w = np.array(quaternion) / norm
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
