"""The GLB writer: a mesh cut into named, nested, coloured parts that ordinary viewers show."""

import json
import struct
from typing import Any, BinaryIO

from numpy.typing import NDArray

from segcore.appearance import Appearance
from segcore.errors import LimitExceeded
from segcore.hierarchy import Hierarchy
from segcore.io.gltf.writer_appearance import add_attributes, name_groups
from segcore.io.gltf.writer_features import add_features
from segcore.io.gltf.writer_geometry import place
from segcore.io.gltf.writer_scene import all_levels_drawing, level_drawing, scene_document
from segcore.io.names import SegmentNames, segment_names
from segcore.io.slices import group
from segcore.mesh import Mesh

_LARGEST_FILE = 2**32 - 1  # the lengths in a GLB file are 32 bits


def write_glb(
    target: BinaryIO,
    mesh: Mesh,
    hierarchy: Hierarchy,
    segments: int | None = None,
    *,
    all_levels: bool = False,
    features: bool = False,
    names: SegmentNames | None = None,
) -> None:
    """Write a mesh as binary glTF 2.0 with a material for each segment and the tree of cuts as nested nodes.

    glTF node i is node i of the hierarchy, nested as there. The nodes that are segments at this level carry the
    geometry and are called ``segment k``, the ones above them ``group i``. All share one POSITION accessor in input
    vertex order (vertices that no face uses are moved to the centre of the others) and hold every input face,
    degenerate ones too, as slices of one index buffer. ``extras`` of a node: ``level``, ``label``, ``area`` (squared
    units of the mesh), ``faces``, ``cut_value`` (null where nothing cuts it), and where it carries faces
    ``first_face`` and, of a single level, ``segment``.

    With ``all_levels`` the nodes are those of the whole hierarchy and the leaves carry the geometry. Their materials
    are those of this level, and KHR_materials_variants has the ones of every other: variant k - 1 is called
    ``k segments`` (``1 segment`` for one). Material k is that of label k in every variant.

    With ``features`` the faces have feature ids as well (EXT_mesh_features), which are rows of a table with an entry
    for each node of the whole hierarchy (EXT_structural_metadata): see :mod:`segcore.io.gltf.writer_features`.

    Where the mesh has an appearance, NORMAL and TEXCOORD_0 are written, and the colours of the vertices as ``_COLOR_0``
    (sRGB and opacity, normalized bytes), as COLOR_0 would tint the materials. Vertices that look different in
    different faces have further entries after the V of the input. ``extras.groups`` of a node with faces has the names
    of the input's groups that reach into it.

    Way back to the input: ``extras.input_faces`` of the scene names a buffer view of little-endian uint32; triangle t
    of a node is input face ``input_faces[first_face + t]``.

    Coordinates that float32 would round visibly are stored relative to the centre, the root node carrying the offset
    (and the unit, for meshes far smaller or larger than anything float32 can square).

    Parameters
    ----------
    target : a binary file; needs ``write`` only.
    segments : the number of segments K, by default the automatic one.
    names : what segments are called in place of ``segment k``.

    Raises
    ------
    InvalidParameters
        Where ``segments`` is not in 1..max_segments.
    LimitExceeded
        Where the file would be larger than the 4 GiB of the format.
    """
    drawing = all_levels_drawing(hierarchy, segments) if all_levels else level_drawing(hierarchy, segments)
    look = mesh.appearance or Appearance()
    placement = place(mesh)
    slices = group(drawing.of_face, len(drawing.nodes))
    corners = mesh.faces if look.corners is None else look.corners
    blobs = [placement.positions, corners[slices.faces].astype("<u4"), slices.faces.astype("<u4")]
    called = segment_names(names, len(drawing.nodes))
    document = scene_document(hierarchy, drawing, placement, slices, [blob.nbytes for blob in blobs], called)
    add_attributes(document, blobs, look)
    name_groups(document, look, slices)
    if features:
        add_features(document, blobs, hierarchy, drawing.nodes, slices, corners)
    _write_container(target, document, blobs)


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
