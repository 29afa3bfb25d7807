"""The hierarchy in a GLB file: EXT_mesh_features with a property table of EXT_structural_metadata.

References
----------
https://github.com/KhronosGroup/glTF/tree/main/extensions/2.0/Vendor, EXT_mesh_features and EXT_structural_metadata.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from segcore.arrays import IntArray
from segcore.hierarchy import Hierarchy
from segcore.io.gltf.glb_file import GlbFile
from segcore.io.labels import node_documents
from segcore.io.slices import Slices

_FEATURES, _METADATA = "EXT_mesh_features", "EXT_structural_metadata"
_FLOAT, _ARRAY_BUFFER = 5126, 34962
_NONE = -1  # the parent of the root, and the cut value and the step of a node that nothing cuts
_NUMBERS: dict[str, tuple[str, str, str]] = {
    "parent": ("INT32", "<i4", "Row of the node that this one was cut from."),
    "level": ("UINT32", "<u4", "Smallest number of segments at which the node is a segment."),
    "label": ("UINT32", "<u4", "Label of the node wherever it is a segment."),
    "faces": ("UINT32", "<u4", "Number of faces of the input."),
    "area": ("FLOAT64", "<f8", "Area in squared units of the mesh."),
    "cut_value": ("FLOAT64", "<f8", "Value of the cut that splits the node."),
    "step": ("INT32", "<i4", "Step of the cut that splits the node."),
}
_OPTIONAL = ("parent", "cut_value", "step")


def add_features(glb: GlbFile, hierarchy: Hierarchy, nodes: IntArray, slices: Slices, corners: IntArray) -> None:
    """Add the feature ids of its node to each primitive, and the table of all nodes to the document.

    Row i of property table 0 is node i of the hierarchy: its name, parent, level, label, faces, area, cut value and
    step. An infinite cut value is left out, as those of leaves are.

    Parameters
    ----------
    nodes : (K,) the node of each primitive.
    slices : the faces of each primitive.
    corners : (F, 3) the rows of the attributes of each input face.
    """
    document = glb.document
    document.setdefault("extensionsUsed", []).extend([_FEATURES, _METADATA])
    rows = document["accessors"][0]["count"]
    layer_of, layers = _layers(nodes, slices, corners, rows, hierarchy.node_count)
    accessors = [_accessor(glb, layer) for layer in layers]
    counts = np.bincount(layer_of).tolist()
    for mesh, layer in zip(document["meshes"], layer_of, strict=True):
        primitive = mesh["primitives"][0]
        primitive["attributes"]["_FEATURE_ID_0"] = accessors[layer]
        ids = _feature_ids(counts[layer], hierarchy.node_count)
        primitive.setdefault("extensions", {})[_FEATURES] = {"featureIds": [ids]}
    document.setdefault("extensions", {})[_METADATA] = {
        "schema": {"id": "cleave_hierarchy", "classes": {"node": _class()}},
        "propertyTables": [_table(glb, hierarchy)],
    }


def _layers(
    nodes: IntArray, slices: Slices, corners: IntArray, rows: int, nothing: int
) -> tuple[list[int], list[NDArray[np.float32]]]:
    """The layer of each part, and the ids of each layer, (rows,) each.

    Adjacent parts share vertices, and a vertex has one id in an attribute. Therefore such parts use different layers:
    each part uses the first layer in which none of its vertices has an id.
    """
    layers: list[NDArray[np.float32]] = []
    layer_of = []
    for part, node in enumerate(nodes.tolist()):
        used = corners[slices[part]]
        free = (k for k, ids in enumerate(layers) if (ids[used] == nothing).all())
        layer = next(free, len(layers))
        if layer == len(layers):
            layers.append(np.full(rows, nothing, dtype="<f4"))  # the only type of attributes for more than 2**16
        layers[layer][used] = node
        layer_of.append(layer)
    return layer_of, layers


def _feature_ids(count: int, nothing: int) -> dict[str, Any]:
    return {"label": "node", "attribute": 0, "featureCount": count, "nullFeatureId": nothing, "propertyTable": 0}


def _accessor(glb: GlbFile, ids: NDArray[np.float32]) -> int:
    view = glb.append_view(ids, target=_ARRAY_BUFFER)
    accessors = glb.document["accessors"]
    accessors.append({"bufferView": view, "componentType": _FLOAT, "type": "SCALAR", "count": len(ids)})
    return len(accessors) - 1


def _class() -> dict[str, Any]:
    properties: dict[str, dict[str, Any]] = {
        name: {"type": "SCALAR", "componentType": kind, "description": description}
        | ({"noData": _NONE} if name in _OPTIONAL else {"required": True})
        for name, (kind, _, description) in _NUMBERS.items()
    }
    names = {"type": "STRING", "description": "Name of the node in this file.", "required": True}
    return {"name": "Node of the hierarchy of segments", "properties": {"name": names, **properties}}


def _table(glb: GlbFile, hierarchy: Hierarchy) -> dict[str, Any]:
    entries = node_documents(hierarchy)
    properties: dict[str, dict[str, Any]] = {"name": _names(glb, entries)}
    for name, (_, dtype, _) in _NUMBERS.items():
        values = [_NONE if entry[name] is None else entry[name] for entry in entries]
        properties[name] = {"values": glb.append_view(np.array(values, dtype))}
    return {"name": "hierarchy", "class": "node", "count": len(entries), "properties": properties}


def _names(glb: GlbFile, entries: list[dict[str, Any]]) -> dict[str, int]:
    """The names of the nodes of the document, and ``node i`` for all others."""
    shown = {node["extras"]["node"]: node["name"] for node in glb.document["nodes"]}
    names = [shown.get(entry["id"], f"node {entry['id']}") for entry in entries]
    encoded = [name.encode() for name in names]
    offsets = np.cumsum([0, *map(len, encoded)]).astype("<u4")
    return {
        "values": glb.append_view(np.frombuffer(b"".join(encoded), np.uint8)),
        "stringOffsets": glb.append_view(offsets),
    }
