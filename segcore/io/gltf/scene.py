"""The meshes of a glTF scene: their transforms, and the primitives that they consist of."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from segcore.arrays import FloatArray
from segcore.errors import InvalidMesh
from segcore.io.gltf.document import Document, Item, indices, integer, member, number_list, numbers

TRIANGLES, STRIP, FAN = 4, 5, 6  # modes of primitives
INSTANCING = "EXT_mesh_gpu_instancing"

_IDENTITY = np.eye(4)


@dataclass(frozen=True, slots=True, eq=False)
class Instance:
    """A mesh in the scene."""

    node: int
    mesh: int
    transform: FloatArray  # (4, 4) from the mesh to the scene, for column vectors
    name: str  # of the node, else of the mesh, else empty
    skin: int | None = None
    weights: tuple[float, ...] | None = None  # of the morph targets; None if those of the mesh count
    copies: Item | None = None  # the accessors of its copies, by name (EXT_mesh_gpu_instancing)
    copy: int = 0  # the number among the copies of the node


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """The meshes of a scene, and the places of its nodes."""

    instances: list[Instance]
    transforms: dict[int, FloatArray]  # (4, 4) of each node of the scene
    notes: list[str] = field(default_factory=list)


@dataclass(frozen=True, slots=True, eq=False)
class Primitive:
    """Triangles of a mesh."""

    where: str  # the member of the document, for messages
    index: int  # among the primitives of the mesh
    mode: int
    positions: int  # accessor
    indices: int | None  # accessor
    corners: int  # the number of indices, or of positions if there are no indices
    attributes: Item  # all accessors of vertices, by semantic
    material: int | None
    targets: Any = None  # the morph targets as they stand in the document

    @property
    def face_count(self) -> int:
        return self.corners // 3 if self.mode == TRIANGLES else max(self.corners - 2, 0)


def read_scene(document: Document) -> Scene:
    """Return all meshes of the default scene, depth first, children in their order.

    The default scene is the one that the file names, else its first one, else all nodes that are not children.

    Raises
    ------
    InvalidMesh
        If a node is reached twice: the nodes do not form a forest.
    """
    scene = Scene([], {})
    for node, transform in placed_nodes(document, scene_roots(document)):
        scene.transforms[node] = transform
        entry, where = document.item("nodes", node), f"nodes[{node}]"
        if "mesh" not in entry:
            continue
        mesh = integer(entry, "mesh", where)
        skin = integer(entry, "skin", where) if "skin" in entry else None
        copies = _copies(entry, where)
        if skin is not None and copies is not None:  # the extension knows no skins; three.js shows the copies alone
            skin = None
            scene.notes.append(f"The skin of {where} is left out, because {where} has copies ({INSTANCING}).")
        name = _name(entry) or _name(document.item("meshes", mesh))
        weights = number_list(entry, "weights", where) if "weights" in entry else None
        scene.instances.append(Instance(node, mesh, transform, name, skin, weights, copies))
    return scene


def placed_nodes(document: Document, roots: Iterable[int]) -> Iterator[tuple[int, FloatArray]]:
    """Yield the nodes of trees and their (4, 4) transforms, depth first; InvalidMesh if one is reached twice."""
    reached: set[int] = set()
    waiting = [(node, _IDENTITY) for node in reversed(list(roots))]
    while waiting:
        node, parent = waiting.pop()
        if node in reached:
            raise InvalidMesh(f"nodes[{node}] of the glTF file has two parents or is inside itself.")
        reached.add(node)
        entry, where = document.item("nodes", node), f"nodes[{node}]"
        transform = parent @ _local_transform(entry, where)
        yield node, transform
        waiting.extend((child, transform) for child in reversed(indices(entry, "children", where)))


def _copies(entry: Item, where: str) -> Item | None:
    extensions = entry.get("extensions")
    if not isinstance(extensions, dict) or INSTANCING not in extensions:
        return None
    where = f"{where}.extensions.{INSTANCING}"
    return member(member(entry["extensions"], INSTANCING, where), "attributes", where)


def _name(entry: Item) -> str:
    name = entry.get("name")
    return name if isinstance(name, str) else ""


def scene_roots(document: Document) -> list[int]:
    """Return the top nodes of the default scene."""
    if document.count("scenes"):
        scene = integer(document.root, "scene", "the top level", 0)
        return indices(document.item("scenes", scene), "nodes", f"scenes[{scene}]")
    return top_nodes(document)


def top_nodes(document: Document) -> list[int]:
    """Return the nodes that are not children, whether a scene has them or not."""
    nodes = range(document.count("nodes"))
    children = {
        child for node in nodes for child in indices(document.item("nodes", node), "children", f"nodes[{node}]")
    }
    return [node for node in nodes if node not in children]


def _local_transform(node: Item, where: str) -> FloatArray:
    if "matrix" in node:
        return np.array(numbers(node, "matrix", where, _IDENTITY.ravel().tolist())).reshape(4, 4).T
    transform = np.eye(4)
    quaternion = np.array([numbers(node, "rotation", where, [0.0, 0.0, 0.0, 1.0])])
    rotation = rotations(quaternion, f"{where}.rotation")[0]
    transform[:3, :3] = rotation * numbers(node, "scale", where, [1.0, 1.0, 1.0])
    transform[:3, 3] = numbers(node, "translation", where, [0.0, 0.0, 0.0])
    return transform


def rotations(quaternions: FloatArray, where: str) -> FloatArray:
    """(N, 3, 3) rotations of quaternions (N, 4) in the order x, y, z, w, which are normalized first."""
    norm = np.linalg.norm(quaternions, axis=1, keepdims=True)
    if not ((norm > 0) & (norm < np.inf)).all():
        raise InvalidMesh(f"{where} of the glTF file is not a rotation.")
    x, y, z, w = (quaternions / norm).T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows, dtype=np.float64), 2, 0)
