"""Objects of their own for the parts of an object."""

import bmesh
import bpy
import numpy as np

from ..arrays import BoolArray, IntArray
from ..parts import Parts


def separate(entry: bpy.types.Object, parts: Parts) -> list[bpy.types.Object]:
    """Divide an object by parts of its polygons, and return the objects, which are named after object and part.

    As with Blender's own *Separate*, the object itself becomes the first part, and the others are copies of it, with
    its modifiers, materials and vertex groups, in its collections. Edges and vertices without a polygon stay with the
    first part. A mesh that other objects use stays as it is.
    """
    whole, base = entry.data, entry.name
    pieces = _pieces(whole, parts.labels)
    if len(pieces) < 2:
        return [entry]
    objects = [entry, *(_copy(entry) for _ in range(len(pieces) - 1))]
    for made, (label, mesh) in zip(objects, pieces.items(), strict=True):
        made.data = mesh
        made.name = made.data.name = f"{base} {parts.names[label]}"
    if whole.users == 0:
        bpy.data.meshes.remove(whole)
    return objects


def _copy(entry: bpy.types.Object) -> bpy.types.Object:
    made = entry.copy()
    for collection in entry.users_collection:
        collection.objects.link(made)
    made.select_set(True)
    return made


def _pieces(mesh: bpy.types.Mesh, labels: IntArray) -> dict[int, bpy.types.Mesh]:
    """A mesh for each label, in their order. The mesh is halved again and again: a copy for each would take longer."""
    used = np.unique(labels)
    if len(used) == 1:
        return {int(used[0]): mesh}
    found: dict[int, bpy.types.Mesh] = {}
    is_low = labels < used[len(used) // 2]
    for keeps in (is_low, ~is_low):
        half = _piece(mesh, keeps, keeps_loose=keeps is is_low)
        pieces = _pieces(half, labels[keeps])
        if half not in pieces.values():
            bpy.data.meshes.remove(half)
        found |= pieces
    return found


def _piece(whole: bpy.types.Mesh, keeps: BoolArray, keeps_loose: bool) -> bpy.types.Mesh:
    """A mesh with some of the polygons alone, in their order."""
    mesh = whole.copy()
    edited = bmesh.new()
    try:
        edited.from_mesh(mesh)
        if not keeps_loose:
            bmesh.ops.delete(edited, geom=[edge for edge in edited.edges if edge.is_wire], context="EDGES")
            bmesh.ops.delete(edited, geom=[vertex for vertex in edited.verts if not vertex.link_faces], context="VERTS")
        others = [face for face, is_kept in zip(edited.faces, keeps.tolist(), strict=True) if not is_kept]
        bmesh.ops.delete(edited, geom=others, context="FACES")
        edited.to_mesh(mesh)
    finally:
        edited.free()
    return mesh
