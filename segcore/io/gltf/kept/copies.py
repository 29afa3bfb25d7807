"""Copies of a mesh (EXT_mesh_gpu_instancing) whose faces belong to different parts."""

import copy as copying
from collections.abc import Callable

import numpy as np

from segcore.errors import InvalidMesh
from segcore.io.gltf.accessors import Accessors
from segcore.io.gltf.document import Item
from segcore.io.gltf.kept.asset import KeptAsset
from segcore.io.gltf.kept.uses import Use
from segcore.io.gltf.scene import INSTANCING

_OF_COPIES = (INSTANCING, "EXT_instance_features")  # extensions of nodes that refer to copies
_MOVED = ("mesh", "skin", "weights")


def separate_copies(
    asset: KeptAsset, accessors: Accessors, node: Item, uses: list[Use], mesh_of: Callable[[Use], int]
) -> None:
    """Give a node a child for each set of copies with the same parts, in place of its own mesh.

    Parameters
    ----------
    uses : the copies in their order.
    mesh_of : returns the mesh that is divided as a use is.
    """
    extensions = node.pop("extensions")
    moved = {name: extensions.pop(name) for name in _OF_COPIES if name in extensions}
    if extensions:
        node["extensions"] = extensions
    entry = {name: node.pop(name) for name in _MOVED if name in node}
    if "name" in node:
        entry["name"] = node["name"]
    alike: dict[bytes, list[Use]] = {}
    for use in uses:
        alike.setdefault(use.key, []).append(use)
    for same in alike.values():
        rows = np.array([use.copy for use in same])
        own = copying.deepcopy(moved)
        attributes = own[INSTANCING]["attributes"]
        for name, source in attributes.items():
            attributes[name] = _chosen(asset, accessors, source, rows)
        child = asset.add("nodes", {**entry, "mesh": mesh_of(same[0]), "extensions": own})
        node.setdefault("children", []).append(child)


def _chosen(asset: KeptAsset, accessors: Accessors, source: int, rows: np.ndarray) -> int:
    """An accessor with some of the rows of another one."""
    entry = {
        name: value
        for name, value in asset.root["accessors"][source].items()
        if name not in ("bufferView", "byteOffset", "sparse", "min", "max")
    }
    values = accessors.stored(source)
    if len(values) <= rows.max():
        raise InvalidMesh(f"accessors[{source}] of the glTF file has fewer values than its mesh has copies.")
    values = values[rows].astype(accessors.dtype(source), copy=False)
    return asset.add(
        "accessors", {**entry, "count": len(rows), "bufferView": asset.add_rows(values, is_attribute=True)}
    )
