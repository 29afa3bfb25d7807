"""Skins in their rest pose: the joints are where the nodes of the file have them."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from segcore.arrays import FloatArray
from segcore.errors import InvalidMesh, LimitExceeded
from segcore.io.gltf.accessors import Accessors
from segcore.io.gltf.document import Document, Item, indices, integer
from segcore.io.gltf.scene import Scene, placed_nodes, top_nodes

_MOST_SETS = 8  # of four joints each; exporters write at most two. Set by hand
_CHUNK = 2**15  # vertices that are blended at a time

Influences = tuple[tuple[int, int], ...]  # the accessors of the joints and of the weights of each set


@dataclass(frozen=True, slots=True, eq=False)
class Blend:
    """The transforms of consecutive vertices."""

    rows: slice
    matrices: FloatArray  # (N, 3, 4)


def influences(attributes: Item, where: str) -> Influences:
    """Return JOINTS_0 and WEIGHTS_0, JOINTS_1 and WEIGHTS_1, ... of a primitive; empty if it has none."""
    sets: list[tuple[int, int]] = []
    while f"JOINTS_{len(sets)}" in attributes and f"WEIGHTS_{len(sets)}" in attributes:
        k = len(sets)
        sets.append((integer(attributes, f"JOINTS_{k}", where), integer(attributes, f"WEIGHTS_{k}", where)))
        if len(sets) > _MOST_SETS:
            raise LimitExceeded(
                f"{where} of the glTF file has more than {4 * _MOST_SETS} joints for each vertex: export fewer."
            )
    return tuple(sets)


class Skins:
    """The joint matrices of all skins, computed once for each."""

    def __init__(self, document: Document, accessors: Accessors, scene: Scene) -> None:
        self._document = document
        self._accessors = accessors
        self._transforms = scene.transforms
        self._elsewhere: dict[int, FloatArray] | None = None  # all nodes, if a joint is outside the scene
        self._matrices: dict[int, FloatArray] = {}

    def blends(self, skin: int, sets: Influences, vertex_count: int) -> Iterator[Blend]:
        """Yield the transform of every vertex: the sum of weight times joint matrix.

        The absolute weights of a vertex are scaled to the sum 1; if all are zero, its first joint has the weight 1.
        Joints without weight do not matter, whatever their numbers.
        """
        joint_matrices = self._joint_matrices(skin)
        joints = [self._joints(source, vertex_count) for source, _ in sets]
        weights = [self._weights(source, vertex_count) for _, source in sets]
        for start in range(0, vertex_count, _CHUNK):
            rows = slice(start, min(start + _CHUNK, vertex_count))
            share = np.concatenate([values[rows] for values in weights], axis=1, dtype=np.float64)
            total = np.abs(share).sum(axis=1)
            share[total == 0, 0] = total[total == 0] = 1.0
            share /= total[:, None]
            chosen = np.concatenate([values[rows] for values in joints], axis=1, dtype=np.int64)
            chosen[share == 0] = 0
            if chosen.max(initial=0) >= len(joint_matrices):
                raise InvalidMesh(
                    f"skins[{skin}] of the glTF file has {len(joint_matrices)} joints, but a vertex that it moves "
                    f"refers to joint {chosen.max()}: export the file again."
                )
            matrices = np.zeros((len(share), 3, 4))
            for k in range(share.shape[1]):
                matrices += share[:, k, None, None] * joint_matrices[chosen[:, k]]
            yield Blend(rows, matrices)

    def _joint_matrices(self, skin: int) -> FloatArray:
        """(J, 3, 4) the transforms of the joints times the inverse bind matrices, which are 1 if they are missing."""
        if skin in self._matrices:
            return self._matrices[skin]
        entry, where = self._document.item("skins", skin), f"skins[{skin}]"
        joints = indices(entry, "joints", where)
        if not joints:
            raise InvalidMesh(f"{where} of the glTF file has no joints: export the file again.")
        places = np.stack([self._transform(joint, where) for joint in joints])
        if "inverseBindMatrices" in entry:
            places = np.einsum("nij,njk->nik", places, self._inverse_binds(entry, where, len(joints)))
        self._matrices[skin] = places[:, :3]
        return self._matrices[skin]

    def _inverse_binds(self, entry: Item, where: str, count: int) -> FloatArray:
        source = integer(entry, "inverseBindMatrices", where)
        if self._accessors.count(source) < count:
            raise InvalidMesh(f"{where} of the glTF file has {count} joints, but fewer inverse bind matrices.")
        values = self._accessors.read(source, "MAT4")[:count].astype(np.float64)
        if not np.isfinite(values).all():
            raise InvalidMesh(f"{where}.inverseBindMatrices of the glTF file has a number that is not finite.")
        return values.reshape(-1, 4, 4).transpose(0, 2, 1)

    def _transform(self, joint: int, where: str) -> FloatArray:
        if joint in self._transforms:
            return self._transforms[joint]
        if self._elsewhere is None:
            self._elsewhere = dict(placed_nodes(self._document, top_nodes(self._document)))
        if joint not in self._elsewhere:
            raise InvalidMesh(f"{where} of the glTF file has the joint nodes[{joint}], which is in no tree of nodes.")
        return self._elsewhere[joint]

    def _joints(self, source: int, vertex_count: int) -> NDArray[Any]:
        values = self._accessors.read(source, "VEC4")
        if values.dtype.kind != "u":
            raise InvalidMesh(f"accessors[{source}] of the glTF file must have joints: unsigned whole numbers.")
        return _of_all(values, source, vertex_count)

    def _weights(self, source: int, vertex_count: int) -> NDArray[Any]:
        values = self._accessors.read(source, "VEC4")
        if not np.isfinite(values).all():
            raise InvalidMesh(f"accessors[{source}] of the glTF file has a weight that is not finite.")
        return _of_all(values, source, vertex_count)


def _of_all(values: NDArray[Any], source: int, vertex_count: int) -> NDArray[Any]:
    if len(values) != vertex_count:
        raise InvalidMesh(
            f"accessors[{source}] of the glTF file has values for {len(values)} vertices, but there are {vertex_count}."
        )
    return values
