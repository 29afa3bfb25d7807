"""Parts as attributes, face sets, materials and vertex groups of a mesh."""

from itertools import pairwise

import bpy
import numpy as np

from ..arrays import IntArray
from ..errors import CleaveError
from ..parts import Color, Parts
from .reading import polygon_corners
from .record import keep, record

ATTRIBUTE = "cleave_part"  # the label of every polygon
FACE_SETS = ".sculpt_face_set"
_MARK = "cleave_part"  # a custom property of the materials that the extension makes


def write_attribute(mesh: bpy.types.Mesh, parts: Parts) -> None:
    _write(mesh, ATTRIBUTE, parts.labels)


def write_face_sets(mesh: bpy.types.Mesh, parts: Parts) -> None:
    """Face sets are counted from 1."""
    _write(mesh, FACE_SETS, parts.labels + 1)


def write_materials(mesh: bpy.types.Mesh, parts: Parts) -> None:
    """A material for each part; those of an earlier division are replaced, and the other ones stay in their slots."""
    _remove_materials(mesh)
    first = len(mesh.materials)
    for label, (name, color) in enumerate(zip(parts.names, parts.colors, strict=True)):
        mesh.materials.append(_material(f"{mesh.name} {name}", color, label))
    mesh.polygons.foreach_set("material_index", (parts.labels + first).astype(np.int32))
    mesh.update()


def write_groups(entry: bpy.types.Object, parts: Parts) -> None:
    """A vertex group for each part; the groups of an earlier division are replaced."""
    mesh = entry.data
    for name in record(mesh).get("groups", []):
        if (group := entry.vertex_groups.get(name)) is not None:
            entry.vertex_groups.remove(group)
    made = [entry.vertex_groups.new(name=name) for name in parts.names]
    for group, vertices in zip(made, _vertices_of(mesh, parts), strict=True):
        group.add(vertices, 1.0, "REPLACE")
    keep(mesh, groups=[group.name for group in made])


def check_names(mesh: bpy.types.Mesh) -> None:
    """Raise CleaveError if an attribute that is not the extension's has a name that it needs."""
    for name in (ATTRIBUTE, FACE_SETS):
        found = mesh.attributes.get(name)
        if found is not None and (found.domain, found.data_type) != ("FACE", "INT"):
            raise CleaveError(f"{mesh.name} has another attribute with the name {name}: rename it.")


def _write(mesh: bpy.types.Mesh, name: str, values: IntArray) -> None:
    attribute = mesh.attributes.get(name) or mesh.attributes.new(name, "INT", "FACE")
    attribute.data.foreach_set("value", np.ascontiguousarray(values, dtype=np.int32))
    mesh.update()


def _material(name: str, color: Color, label: int) -> bpy.types.Material:
    material = bpy.data.materials.new(name)
    material[_MARK] = label
    material.diffuse_color = (*color, 1.0)  # in solid view
    if material.node_tree is None:  # before Blender 5
        material.use_nodes = True
    shader = next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    shader.inputs["Base Color"].default_value = (*color, 1.0)
    return material


def _remove_materials(mesh: bpy.types.Mesh) -> None:
    for slot in reversed(range(len(mesh.materials))):
        material = mesh.materials[slot]
        if material is not None and _MARK in material:
            mesh.materials.pop(index=slot)
            if material.users == 0:
                bpy.data.materials.remove(material)


def _vertices_of(mesh: bpy.types.Mesh, parts: Parts) -> list[list[int]]:
    """The vertices of the polygons of each part; those on a border belong to several."""
    corners, sizes = polygon_corners(mesh)
    count = len(mesh.vertices)
    pairs = np.unique(np.repeat(parts.labels.astype(np.int64), sizes) * count + corners)
    starts = np.searchsorted(pairs, count * np.arange(len(parts.names) + 1))
    return [(pairs[a:b] % count).tolist() for a, b in pairwise(starts.tolist())]
