"""The rest pose of a glTF scene: morph targets with their default weights, then skins, else transforms of nodes."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from segcore.arrays import BoolArray, FloatArray, transformed
from segcore.errors import InvalidMesh
from segcore.io.gltf.accessors import Accessors
from segcore.io.gltf.document import Document, integer, number_list
from segcore.io.gltf.scene import Instance, Primitive, Scene
from segcore.io.gltf.skins import Influences, Skins, influences

_POSITION = "POSITION"
_IDENTITY = np.eye(4)

Morphs = tuple[tuple[float, tuple[tuple[str, int], ...]], ...]  # weights, none zero, and accessors by semantic


@dataclass(frozen=True, slots=True)
class Pose:
    """What decides where the vertices of a primitive are; primitives with equal poses share their vertices."""

    positions: int  # accessor
    transform: bytes  # (4, 4) float64; of the identity if there is a skin
    morphs: int  # entry of the list of all morphs; 0 is no morph
    skin: int | None
    influences: Influences

    @property
    def matrix(self) -> FloatArray:
        """(4, 4) from the mesh to the scene."""
        return np.frombuffer(self.transform).reshape(4, 4)


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """A primitive in the scene."""

    instance: Instance
    primitive: Primitive
    pose: Pose


@dataclass(frozen=True, slots=True, eq=False)
class Posed:
    """The vertices of a pose."""

    positions: FloatArray  # (V, 3)
    mirrored: BoolArray  # (V,) of a skin, or (1,) of all vertices: whether the surface is turned inside out


class Poses:
    """Places vertices and their normals."""

    def __init__(self, document: Document, accessors: Accessors, scene: Scene) -> None:
        self._document = document
        self._accessors = accessors
        self._skins = Skins(document, accessors, scene)
        self._morphs: list[Morphs] = [()]
        self._number: dict[Morphs, int] = {(): 0}
        self._of_mesh: dict[str, int] = {}  # the number of the morphs of a primitive with the weights of its mesh
        self._influences: dict[str, Influences] = {}

    def pose(self, instance: Instance, primitive: Primitive) -> Pose:
        """Return the pose of a primitive."""
        morphs = self._morphs_of(instance, primitive)
        sets: Influences = ()
        if instance.skin is not None:
            if primitive.where not in self._influences:
                self._influences[primitive.where] = influences(primitive.attributes, f"{primitive.where}.attributes")
            sets = self._influences[primitive.where]
        transform = _IDENTITY if sets else instance.transform
        return Pose(primitive.positions, transform.tobytes(), morphs, instance.skin if sets else None, sets)

    def vertex_count(self, pose: Pose) -> int:
        return self._accessors.count(pose.positions)

    def morph_count(self, pose: Pose) -> int:
        """Return the number of morph targets that are added to the vertices."""
        return len(self._morphs[pose.morphs])

    def place(self, pose: Pose) -> Posed:
        """Return the vertices of a pose in the scene."""
        values = self._accessors.read(pose.positions, "VEC3").astype(np.float64)
        morphed = self.morphed(pose, _POSITION, values)
        if pose.skin is None:
            matrix = pose.matrix
            moved = transformed(morphed, matrix[:3, :3]) + matrix[:3, 3] if (matrix != _IDENTITY).any() else morphed
            return Posed(moved, np.array([np.linalg.det(matrix[:3, :3]) < 0]))
        mirrored = np.zeros(len(morphed), dtype=bool)
        for blend in self._skins.blends(pose.skin, pose.influences, len(morphed)):
            linear = blend.matrices[:, :, :3]
            morphed[blend.rows] = np.einsum("nij,nj->ni", linear, morphed[blend.rows]) + blend.matrices[:, :, 3]
            mirrored[blend.rows] = _determinants(linear, _cofactors(linear)) < 0
        return Posed(morphed, mirrored)

    def morphed(self, pose: Pose, semantic: str, values: FloatArray) -> FloatArray:
        """(V, K) an attribute plus the weighted ones of the morph targets; changes ``values``."""
        kind = f"VEC{values.shape[1]}"
        for weight, sources in self._morphs[pose.morphs]:
            source = dict(sources).get(semantic)
            if source is None:
                continue
            shift = self._accessors.read(source, kind)
            if len(shift) != len(values):
                raise InvalidMesh(
                    f"accessors[{source}] of the glTF file is a morph target of {len(shift)} vertices, "
                    f"but its mesh has {len(values)}."
                )
            values += weight * shift
        return values

    def normals(self, pose: Pose, values: FloatArray) -> FloatArray | None:
        """(V, 3) normals in the scene, of any length; None if they are not known.

        They are the rows of N inverse(M) for the transform M of each vertex.
        """
        if any("NORMAL" not in dict(sources) for _, sources in self._morphs[pose.morphs]):
            return None
        values = self.morphed(pose, "NORMAL", values)
        if pose.skin is None:
            return _without_skin(values, pose.matrix[:3, :3])
        for blend in self._skins.blends(pose.skin, pose.influences, len(values)):
            linear = blend.matrices[:, :, :3]
            cofactors = _cofactors(linear)
            moved = np.einsum("nij,nj->ni", cofactors, values[blend.rows])
            values[blend.rows] = np.sign(_determinants(linear, cofactors))[:, None] * moved
        return values

    def _morphs_of(self, instance: Instance, primitive: Primitive) -> int:
        if primitive.targets is None:
            return 0
        if instance.weights is not None:
            return self._numbered(primitive, instance.weights)
        if primitive.where not in self._of_mesh:
            where = f"meshes[{instance.mesh}]"
            weights = number_list(self._document.item("meshes", instance.mesh), "weights", where)
            self._of_mesh[primitive.where] = self._numbered(primitive, weights)
        return self._of_mesh[primitive.where]

    def _numbered(self, primitive: Primitive, weights: tuple[float, ...]) -> int:
        morphs = _weighted_targets(primitive.targets, weights, f"{primitive.where}.targets")
        if morphs not in self._number:
            self._number[morphs] = len(self._morphs)
            self._morphs.append(morphs)
        return self._number[morphs]


def _weighted_targets(targets: Any, weights: tuple[float, ...], where: str) -> Morphs:
    """The targets with weights, those with the same accessors added up; targets beyond the weights have none."""
    if not isinstance(targets, list) or not all(isinstance(target, dict) for target in targets):
        raise InvalidMesh(f"{where} of the glTF file must be a list of objects.")
    total: dict[tuple[tuple[str, int], ...], float] = {}
    for i, (target, weight) in enumerate(zip(targets, weights, strict=False)):
        if weight:
            key = tuple((name, integer(target, name, f"{where}[{i}]")) for name in sorted(target))
            total[key] = total.get(key, 0.0) + weight
    return tuple((weight, key) for key, weight in total.items() if weight and key)


def _without_skin(normals: FloatArray, matrix: FloatArray) -> FloatArray | None:
    try:
        return transformed(normals, np.asarray(np.linalg.inv(matrix).T, dtype=np.float64))
    except np.linalg.LinAlgError:
        return None


def _cofactors(matrices: FloatArray) -> FloatArray:
    """(N, 3, 3) determinant times inverse transpose of each matrix, also of singular ones."""
    a, b, c = matrices[:, 0], matrices[:, 1], matrices[:, 2]
    return np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=1)


def _determinants(matrices: FloatArray, cofactors: FloatArray) -> FloatArray:
    determinants: FloatArray = (matrices[:, 0] * cofactors[:, 0]).sum(axis=1)
    return determinants
