"""The JSON of a GLB file: the hierarchy as nodes, and a material for each segment."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from segcore.arrays import FloatArray, IntArray
from segcore.hierarchy import Hierarchy
from segcore.io.gltf.writer_geometry import Placement
from segcore.io.labels import finite_or_none, node_documents
from segcore.io.palette import SegmentColors, linear_rgb, segment_colors
from segcore.io.slices import Slices
from segcore.nary import nary_children

_UNSIGNED_INT, _FLOAT = 5125, 5126
_ARRAY_BUFFER, _ELEMENT_ARRAY_BUFFER = 34962, 34963
VARIANTS = "KHR_materials_variants"
_FACE_BYTES = 12  # three uint32
_FACTS = ("level", "label", "area", "faces", "cut_value", "step")


@dataclass(frozen=True, slots=True, eq=False)
class Drawing:
    """The nodes of a hierarchy that have geometry, and their materials."""

    segments: int  # the level that is shown
    nodes: IntArray  # (D,) the nodes that have geometry; nodes[k] has label k
    of_face: IntArray  # (F,) the entry of ``nodes`` of each face
    material: IntArray  # (D,) at the level that is shown
    variants: IntArray | None = None  # (L, D) the material at each level; None for a drawing of one level


def level_drawing(hierarchy: Hierarchy, segments: int | None) -> Drawing:
    """Return the drawing of the segments of one level."""
    nodes = hierarchy.segment_nodes(segments)
    count = len(nodes)
    return Drawing(count, nodes, hierarchy.labels(segments), np.arange(count, dtype=np.int32))


def all_levels_drawing(hierarchy: Hierarchy, segments: int | None) -> Drawing:
    """Return the drawing of the leaves with the colours of a level, and those of all levels as variants."""
    count = len(hierarchy.segment_nodes(segments))
    leaves = hierarchy.segment_nodes(hierarchy.max_segments)
    variants = level_materials(hierarchy, leaves, range(1, len(leaves) + 1))
    return Drawing(count, leaves, hierarchy.labels(hierarchy.max_segments), variants[count - 1], variants)


def level_materials(hierarchy: Hierarchy, nodes: IntArray, levels: Sequence[int]) -> IntArray:
    """(L, D) the label of each of the nodes of a level with D segments at other levels up to it."""
    of_nodes = replace(hierarchy, face_leaf=nodes)  # a face for each node, so that labels of faces are labels of nodes
    return np.stack([of_nodes.labels(level) for level in levels])


def scene_document(
    hierarchy: Hierarchy,
    drawing: Drawing,
    placement: Placement,
    slices: Slices,
    names: list[str],
    *,
    is_flat: bool = False,
    part_colors: SegmentColors | None = None,
) -> dict[str, Any]:
    """Return the glTF document for a buffer of positions, uint32 corners in slices, and uint32 input faces.

    Parameters
    ----------
    names : (D,) names of the parts that have geometry.
    is_flat : all parts are children of the root, in the order of their labels.
    part_colors : colours of segments by label, in place of the fixed ones.
    """
    faces = len(slices.faces)
    sizes = [placement.positions.nbytes, _FACE_BYTES * faces, 4 * faces]
    offsets = [0, sizes[0], sizes[0] + sizes[1]]
    parts = range(len(drawing.nodes))
    document = {
        "asset": {"version": "2.0", "generator": "Cleave"},
        "scene": 0,
        "scenes": [{"nodes": [0], "extras": _scene_extras(hierarchy, drawing)}],
        "nodes": _nodes(hierarchy, drawing, placement, slices, names, is_flat),
        "meshes": [_mesh(drawing, k, names[k]) for k in parts],
        "materials": segment_materials(names, part_colors),
        "accessors": [_position_accessor(placement.positions), *(_index_accessor(slices, k) for k in parts)],
        "bufferViews": [
            {"buffer": 0, "byteOffset": offsets[0], "byteLength": sizes[0], "target": _ARRAY_BUFFER},
            {"buffer": 0, "byteOffset": offsets[1], "byteLength": sizes[1], "target": _ELEMENT_ARRAY_BUFFER},
            {"buffer": 0, "byteOffset": offsets[2], "byteLength": sizes[2], "name": "input_faces"},
        ],
        "buffers": [{"byteLength": sum(sizes)}],
    }
    return document | ({} if drawing.variants is None else _variants(len(drawing.variants)))


def _scene_extras(hierarchy: Hierarchy, drawing: Drawing) -> dict[str, Any]:
    faces = {"bufferView": 2, "componentType": _UNSIGNED_INT, "count": len(drawing.of_face)}
    return scene_facts(hierarchy, drawing) | {"input_faces": faces}


def scene_facts(hierarchy: Hierarchy, drawing: Drawing) -> dict[str, Any]:
    """Return the facts on the hierarchy that the extras of a scene have."""
    splits = len(drawing.nodes) - 1
    return {
        "segments": drawing.segments,
        "max_segments": hierarchy.max_segments,
        "automatic_segments": hierarchy.automatic_segments,
        "limit_reached": hierarchy.limit_reached,
        "split_node": hierarchy.split_node[:splits].tolist(),
        "step": hierarchy.step[:splits].tolist(),
        "cut_value": [finite_or_none(value) for value in hierarchy.cut_value[:splits].tolist()],
    }


def _variants(count: int) -> dict[str, Any]:
    names = [{"name": name} for name in variant_names(range(1, count + 1))]
    return {"extensionsUsed": [VARIANTS], "extensions": {VARIANTS: {"variants": names}}}


def variant_names(levels: Sequence[int]) -> list[str]:
    """Return the names of the variants of levels, which are numbers of segments."""
    return [f"{k} segment{'s' if k > 1 else ''}" for k in levels]


def _nodes(
    hierarchy: Hierarchy,
    drawing: Drawing,
    placement: Placement,
    slices: Slices,
    names: list[str],
    is_flat: bool,
) -> list[dict[str, Any]]:
    """The nodes of the tree of steps, down to those that have geometry, in the order of their numbers."""
    part_of = {node: k for k, node in enumerate(drawing.nodes.tolist())}
    splits = len(part_of) - 1
    children = nary_children(hierarchy.split_node[:splits], hierarchy.step[:splits])
    if is_flat and splits:
        children = [drawing.nodes.tolist(), *([] for _ in children[1:])]
    entries = [entry for entry in node_documents(hierarchy)[: 2 * splits + 1] if _is_shown(entry, part_of, children)]
    place = {entry["id"]: i for i, entry in enumerate(entries)}
    nodes: list[dict[str, Any]] = []
    for entry in entries:
        node = entry["id"]
        extras = {"node": node} | {name: entry[name] for name in _FACTS}
        if (k := part_of.get(node)) is None:
            below = [place[child] for child in children[node]]
            nodes.append({"name": f"group {node}", "children": below, "extras": extras})
        else:
            extras |= {"first_face": int(slices.start[k])} | ({"segment": k} if drawing.variants is None else {})
            nodes.append({"name": names[k], "mesh": k, "extras": extras})
    nodes[0] |= placement.members
    return nodes


def _is_shown(entry: dict[str, Any], part_of: dict[int, int], children: list[list[int]]) -> bool:
    """Whether a node has geometry or children; the others are passed over."""
    return entry["id"] in part_of or bool(children[entry["id"]])


def _mesh(drawing: Drawing, k: int, name: str) -> dict[str, Any]:
    primitive = {"attributes": {"POSITION": 0}, "indices": k + 1, "material": int(drawing.material[k])}
    if drawing.variants is not None:
        primitive["extensions"] = {VARIANTS: {"mappings": mappings(drawing.variants[:, k])}}
    return {"name": name, "primitives": [primitive]}


def mappings(materials: IntArray) -> list[dict[str, Any]]:
    """Return the materials of a part with the variants that use them; entry k of ``materials`` is that of variant k."""
    return [
        {"material": material, "variants": np.flatnonzero(materials == material).tolist()}
        for material in np.unique(materials).tolist()
    ]


def segment_materials(names: list[str], part_colors: SegmentColors | None) -> list[dict[str, Any]]:
    """Return the materials of the labels 0, 1, ... in their colours."""
    colors = linear_rgb(segment_colors(len(names), part_colors))
    return [_material(name, color) for name, color in zip(names, colors, strict=True)]


def _material(name: str, color: FloatArray) -> dict[str, Any]:
    return {
        "name": name,
        "doubleSided": True,  # the input may be open or inside out
        "pbrMetallicRoughness": {
            "baseColorFactor": [*(round(channel, 6) for channel in color.tolist()), 1.0],
            "metallicFactor": 0.0,
            "roughnessFactor": 0.8,  # set by hand: matt, with a faint highlight
        },
    }


def _position_accessor(positions: NDArray[np.float32]) -> dict[str, Any]:
    return {
        "bufferView": 0,
        "componentType": _FLOAT,
        "type": "VEC3",
        "count": len(positions),
        "min": positions.min(axis=0).tolist(),
        "max": positions.max(axis=0).tolist(),
    }


def _index_accessor(slices: Slices, k: int) -> dict[str, Any]:
    first, end = int(slices.start[k]), int(slices.start[k + 1])
    return {
        "bufferView": 1,
        "byteOffset": _FACE_BYTES * first,
        "componentType": _UNSIGNED_INT,
        "type": "SCALAR",
        "count": 3 * (end - first),
    }
