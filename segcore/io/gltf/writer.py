"""The GLB writer: a mesh as named, nested, coloured parts that ordinary viewers show."""

from typing import BinaryIO, get_args

from segcore.appearance import Appearance
from segcore.errors import InvalidParameters
from segcore.hierarchy import Hierarchy
from segcore.io.formats import Layout
from segcore.io.gltf.glb_file import GlbFile
from segcore.io.gltf.writer_appearance import add_attributes, name_groups
from segcore.io.gltf.writer_features import add_features
from segcore.io.gltf.writer_geometry import place
from segcore.io.gltf.writer_scene import all_levels_drawing, level_drawing, scene_document
from segcore.io.names import SegmentNames, segment_names
from segcore.io.palette import SegmentColors
from segcore.io.slices import group
from segcore.mesh import Mesh


def write_glb(
    target: BinaryIO,
    mesh: Mesh,
    hierarchy: Hierarchy,
    segments: int | None = None,
    *,
    all_levels: bool = False,
    features: bool = False,
    layout: Layout = "tree",
    names: SegmentNames | None = None,
    part_colors: SegmentColors | None = None,
) -> None:
    """Write a mesh as binary glTF 2.0, with a material for each segment and the hierarchy as nested nodes.

    The glTF nodes are those of the tree of steps (:mod:`segcore.nary`), in the order of their numbers in the hierarchy:
    equal parts are children of one node, and nodes that are passed over are left out. The nodes that are segments at
    this level have the geometry and are called ``segment k``, the nodes above them ``group i``. All share one POSITION
    accessor in input vertex order (vertices that no face uses are moved to the centre of the others) and have every
    input face, degenerate ones too, as slices of one index buffer. ``extras`` of a node: ``node`` (its number in the
    hierarchy), ``level``, ``label``, ``area`` (squared units of the mesh), ``faces``, ``cut_value`` and ``step`` (null
    if nothing cuts it), and if it has faces, ``first_face`` and, of a single level, ``segment``.

    With the layout ``flat`` the parts are all children of the root, in the order of their labels.

    With ``all_levels`` the nodes are those of the whole hierarchy, and the leaves have the geometry. Their materials
    are those of this level, and KHR_materials_variants has the ones of every other: variant k - 1 is called
    ``k segments`` (``1 segment`` for one). Material k is that of label k in every variant.

    With ``features`` the faces have feature ids as well (EXT_mesh_features), which are rows of a table with an entry
    for each node of the whole hierarchy (EXT_structural_metadata): see :mod:`segcore.io.gltf.writer_features`.

    If the mesh has an appearance, NORMAL and TEXCOORD_0 are written, and the colours of the vertices as ``_COLOR_0``
    (sRGB and opacity, normalized bytes), because COLOR_0 would tint the materials. The further rows of the appearance
    follow the V vertices of the input. ``extras.groups`` of a node with faces lists the groups of the input that its
    faces are in.

    ``extras`` of the scene has the splits of these levels, ``split_node``, ``step`` and ``cut_value``, and
    ``limit_reached``, as in :class:`segcore.hierarchy.Hierarchy`. Its ``input_faces`` names a buffer view of
    little-endian uint32 that maps the faces to the input: triangle t of a node is input face
    ``input_faces[first_face + t]``.

    Coordinates that float32 would round visibly are stored relative to the centre; then the root node has the offset
    (and the unit, for meshes far smaller or larger than anything that float32 can square). If the unit of the mesh or
    the axis that points up is known and is not that of glTF, metres and y, the transform of the root node converts the
    mesh; the positions do not change. ``extras`` of the scene has ``unit``, ``up`` and ``shown_up``, as the report of
    the mesh has them.

    Parameters
    ----------
    target : a binary file; needs ``write`` only.
    segments : the number of segments K, by default the automatic one.
    names : names of segments by label, in place of ``segment k``.
    part_colors : colours of segments by label, in place of the fixed ones.

    Raises
    ------
    InvalidParameters
        If ``segments`` is not in 1..max_segments, or there is no such layout.
    LimitExceeded
        If the file would be larger than the 4 GiB of the format.
    """
    if layout not in get_args(Layout):
        raise InvalidParameters(f"The layout is {' or '.join(get_args(Layout))}, not {layout!r}.")
    drawing = all_levels_drawing(hierarchy, segments) if all_levels else level_drawing(hierarchy, segments)
    look = mesh.appearance or Appearance()
    placement = place(mesh)
    slices = group(drawing.of_face, len(drawing.nodes))
    corners = mesh.faces if look.corners is None else look.corners
    document = scene_document(
        hierarchy,
        drawing,
        placement,
        slices,
        segment_names(names, len(drawing.nodes)),
        is_flat=layout == "flat",
        part_colors=part_colors,
    )
    known = mesh.coordinates
    document["scenes"][0]["extras"] |= {"unit": known.unit, "up": known.up, "shown_up": known.shown_up}
    glb = GlbFile(document, [placement.positions, corners[slices.faces].astype("<u4"), slices.faces.astype("<u4")])
    add_attributes(glb, look)
    name_groups(glb, look, slices)
    if features:
        add_features(glb, hierarchy, drawing.nodes, slices, corners)
    glb.write(target)
