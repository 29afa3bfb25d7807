"""Copies of the mesh of a node (EXT_mesh_gpu_instancing)."""

from dataclasses import replace

import numpy as np

from segcore.arrays import FloatArray
from segcore.errors import InvalidMesh
from segcore.io.gltf.accessors import Accessors
from segcore.io.gltf.document import Item, integer
from segcore.io.gltf.scene import INSTANCING, Instance, rotations

_KINDS = {"TRANSLATION": "VEC3", "ROTATION": "VEC4", "SCALE": "VEC3"}


def copy_count(instance: Instance, accessors: Accessors) -> int:
    """Return the number of copies of a mesh, 1 if the node has no copies; reads no data."""
    where = _where(instance)
    counts = {name: accessors.count(source) for name, source in _sources(instance.copies, where).items()}
    if len(set(counts.values())) > 1:
        raise InvalidMesh(f"The accessors of {where} of the glTF file differ in their numbers of copies: {counts}.")
    return next(iter(counts.values()), 1)


def expanded(instance: Instance, accessors: Accessors) -> list[Instance]:
    """Return the copies of a mesh: each has the transform of the node times its own."""
    where = _where(instance)
    sources = _sources(instance.copies, where)
    if not sources:
        return [instance]
    count = copy_count(instance, accessors)
    own = np.tile(np.eye(4), (count, 1, 1))
    values = {name: _numbers(accessors, source, name, where) for name, source in sources.items()}
    if "ROTATION" in values:
        own[:, :3, :3] = rotations(values["ROTATION"], f"{where}.attributes.ROTATION")
    if "SCALE" in values:
        own[:, :3, :3] *= values["SCALE"][:, None, :]
    if "TRANSLATION" in values:
        own[:, :3, 3] = values["TRANSLATION"]
    transforms = np.einsum("ij,njk->nik", instance.transform, own)
    return [replace(instance, transform=transforms[i], copies=None, copy=i) for i in range(count)]


def _where(instance: Instance) -> str:
    return f"nodes[{instance.node}].extensions.{INSTANCING}"


def _sources(copies: Item | None, where: str) -> dict[str, int]:
    return {name: integer(copies, name, where) for name in _KINDS if name in copies} if copies else {}


def _numbers(accessors: Accessors, source: int, name: str, where: str) -> FloatArray:
    values = accessors.read(source, _KINDS[name]).astype(np.float64)
    if not np.isfinite(values).all():
        raise InvalidMesh(f"{where}.attributes.{name} of the glTF file has a number that is not finite.")
    return values
