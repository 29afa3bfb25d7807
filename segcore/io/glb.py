"""The GLB writer: a mesh cut into named, nested, coloured parts that ordinary viewers show."""

import json
import struct
from dataclasses import dataclass
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from segcore.arrays import FloatArray, IntArray
from segcore.errors import LimitExceeded
from segcore.hierarchy import Hierarchy
from segcore.io.labels import node_documents
from segcore.io.palette import linear_rgb, segment_colors
from segcore.mesh import Mesh

_UNSIGNED_INT, _FLOAT = 5125, 5126
_ARRAY_BUFFER, _ELEMENT_ARRAY_BUFFER = 34962, 34963
_LARGEST_FILE = 2**32 - 1  # the lengths in a GLB file are 32 bits
_FAR_OUT = 16.0  # distance from the origin, in extents of the mesh, at which float32 coordinates lose four bits
_PLAIN_EXTENT = (1e-15, 1e15)  # extents whose squares and cubes float32 still holds


@dataclass(frozen=True, slots=True, eq=False)
class _Placement:
    """vertices[i] = translation + scale * positions[i] for every vertex that a face uses."""

    positions: NDArray[np.float32]  # (V, 3)
    translation: list[float]
    scale: float


@dataclass(frozen=True, slots=True, eq=False)
class _Slices:
    """The faces grouped by segment, in input order within each."""

    faces: IntArray  # (F,) input face ids
    start: IntArray  # (K + 1,) segment k owns faces[start[k]:start[k + 1]]


def write_glb(target: BinaryIO, mesh: Mesh, hierarchy: Hierarchy, segments: int | None = None) -> None:
    """Write a mesh as binary glTF 2.0 with one named node and one material for each segment.

    glTF node i is node i of the hierarchy, nested as there; the nodes that are segments at this level carry the
    geometry and are called ``segment k``, the ones above them ``group i``. All share one POSITION accessor in input
    vertex order (vertices that no face uses are moved to the centre of the others) and hold every input face,
    degenerate ones too, as slices of one index buffer. ``extras`` of a node: ``level``, ``area`` (squared units of
    the mesh), ``faces``, ``cut_value`` (null where nothing cuts it), and for a segment ``segment``, ``first_face``.

    Way back to the input: ``extras.input_faces`` of the scene names a buffer view of little-endian uint32; triangle t
    of segment k is input face ``input_faces[first_face + t]``.

    Coordinates that float32 would round visibly are stored relative to the centre, the root node carrying the offset
    (and the unit, for meshes far smaller or larger than anything float32 can square).

    Parameters
    ----------
    target : a binary file; needs ``write`` only.
    segments : the number of segments K, by default the automatic one.

    Raises
    ------
    InvalidParameters
        Where ``segments`` is not in 1..max_segments.
    LimitExceeded
        Where the file would be larger than the 4 GiB of the format.
    """
    labels = hierarchy.labels(segments)
    nodes = hierarchy.segment_nodes(segments)
    placement = _place(mesh)
    slices = _group(labels, len(nodes))
    blobs = [placement.positions, mesh.faces[slices.faces].astype("<u4"), slices.faces.astype("<u4")]
    document = _document(hierarchy, nodes, placement, slices, [blob.nbytes for blob in blobs])
    _write_container(target, document, blobs)


def _place(mesh: Mesh) -> _Placement:
    used = np.zeros(len(mesh.vertices), dtype=bool)
    used[mesh.faces] = True
    low, high = mesh.vertices[used].min(axis=0), mesh.vertices[used].max(axis=0)
    extent = float((high - low).max())
    centre = 0.5 * low + 0.5 * high
    scale = 1.0 if extent == 0 or _PLAIN_EXTENT[0] <= extent <= _PLAIN_EXTENT[1] else extent
    if scale == 1.0 and np.abs([low, high]).max() <= _FAR_OUT * extent:
        positions, translation = mesh.vertices, np.zeros(3)
    else:
        positions, translation = (np.clip(mesh.vertices, low, high) - centre) / scale, centre
    inside = np.where(used[:, None], positions, (centre - translation) / scale)
    return _Placement(inside.astype("<f4"), translation.tolist(), scale)


def _group(labels: IntArray, count: int) -> _Slices:
    keys = labels.astype(np.uint16) if count <= 2**16 else labels  # 16-bit keys are sorted by radix
    order = np.argsort(keys, kind="stable").astype(np.int32)
    start = np.concatenate([[0], np.cumsum(np.bincount(labels, minlength=count))]).astype(np.int32)
    return _Slices(order, start)


def _document(
    hierarchy: Hierarchy, nodes: IntArray, placement: _Placement, slices: _Slices, sizes: list[int]
) -> dict[str, Any]:
    offsets = [0, sizes[0], sizes[0] + sizes[1]]
    segments = range(len(nodes))
    return {
        "asset": {"version": "2.0", "generator": "Cleave"},
        "scene": 0,
        "scenes": [{"nodes": [0], "extras": _scene_extras(hierarchy, len(nodes), len(slices.faces))}],
        "nodes": _nodes(hierarchy, nodes, placement, slices),
        "meshes": [_mesh(k) for k in segments],
        "materials": [_material(k, color) for k, color in enumerate(linear_rgb(segment_colors(len(nodes))))],
        "accessors": [_position_accessor(placement.positions), *(_index_accessor(slices, k) for k in segments)],
        "bufferViews": [
            {"buffer": 0, "byteOffset": offsets[0], "byteLength": sizes[0], "target": _ARRAY_BUFFER},
            {"buffer": 0, "byteOffset": offsets[1], "byteLength": sizes[1], "target": _ELEMENT_ARRAY_BUFFER},
            {"buffer": 0, "byteOffset": offsets[2], "byteLength": sizes[2], "name": "input_faces"},
        ],
        "buffers": [{"byteLength": sum(sizes)}],
    }


def _scene_extras(hierarchy: Hierarchy, segments: int, faces: int) -> dict[str, Any]:
    return {
        "segments": segments,
        "max_segments": hierarchy.max_segments,
        "automatic_segments": hierarchy.automatic_segments,
        "input_faces": {"bufferView": 2, "componentType": _UNSIGNED_INT, "count": faces},
    }


def _nodes(
    hierarchy: Hierarchy, segment_nodes: IntArray, placement: _Placement, slices: _Slices
) -> list[dict[str, Any]]:
    segment_of = {node: k for k, node in enumerate(segment_nodes.tolist())}
    documents = node_documents(hierarchy)[: 2 * len(segment_nodes) - 1]
    nodes = []
    for entry in documents:
        extras = {name: entry[name] for name in ("level", "area", "faces", "cut_value")}
        if (k := segment_of.get(entry["id"])) is None:
            nodes.append({"name": f"group {entry['id']}", "children": entry["children"], "extras": extras})
        else:
            extras |= {"segment": k, "first_face": int(slices.start[k])}
            nodes.append({"name": f"segment {k}", "mesh": k, "extras": extras})
    if any(placement.translation):
        nodes[0]["translation"] = placement.translation
    if placement.scale != 1.0:
        nodes[0]["scale"] = [placement.scale] * 3
    return nodes


def _mesh(k: int) -> dict[str, Any]:
    return {"name": f"segment {k}", "primitives": [{"attributes": {"POSITION": 0}, "indices": k + 1, "material": k}]}


def _material(k: int, color: FloatArray) -> dict[str, Any]:
    return {
        "name": f"segment {k}",
        "doubleSided": True,  # the input may be open or turned inside out
        "pbrMetallicRoughness": {
            "baseColorFactor": [*(round(channel, 6) for channel in color.tolist()), 1.0],
            "metallicFactor": 0.0,
            "roughnessFactor": 0.8,
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


def _index_accessor(slices: _Slices, k: int) -> dict[str, Any]:
    first, end = int(slices.start[k]), int(slices.start[k + 1])
    return {
        "bufferView": 1,
        "byteOffset": 12 * first,
        "componentType": _UNSIGNED_INT,
        "type": "SCALAR",
        "count": 3 * (end - first),
    }


def _write_container(target: BinaryIO, document: dict[str, Any], blobs: list[NDArray[Any]]) -> None:
    text = json.dumps(document, separators=(",", ":"), allow_nan=False).encode("ascii")
    text += b" " * (-len(text) % 4)
    binary_length = sum(blob.nbytes for blob in blobs)  # every blob is a whole number of 4-byte words
    length = 12 + 8 + len(text) + 8 + binary_length
    if length > _LARGEST_FILE:
        raise LimitExceeded(f"A GLB file holds at most 4 GiB, and this mesh needs {length} bytes: reduce the mesh.")
    target.write(struct.pack("<4sII", b"glTF", 2, length))
    target.write(struct.pack("<I4s", len(text), b"JSON") + text)
    target.write(struct.pack("<I4s", binary_length, b"BIN\0"))
    for blob in blobs:
        target.write(blob.data.cast("B"))
