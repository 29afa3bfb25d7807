"""The meshes of objects as Cleave gets them."""

from dataclasses import dataclass

import bpy
import numpy as np

from ..arrays import FloatArray, IntArray
from ..errors import CleaveError
from ..parts import Parts
from ..polygons import Polygons, digest
from ..shape import shape_matrix


@dataclass(frozen=True, slots=True, eq=False)
class Subject:
    """A mesh, the objects that have it, and its polygons in the shape that the first object has in the world."""

    objects: list[bpy.types.Object]  # the first one gives the modifiers and the shape
    polygons: Polygons
    ply: bytes  # the file that Cleave gets
    digest: str  # of that file
    topology: str  # a digest of the polygons
    note: str | None  # what differs from what was asked

    @property
    def mesh(self) -> bpy.types.Mesh:
        return self.objects[0].data

    @property
    def name(self) -> str:
        """The name of the first object."""
        return str(self.objects[0].name)

    def of_polygons(self, parts: Parts) -> Parts:
        """Parts of the polygons from parts of the triangles."""
        return Parts(self.polygons.labels(parts.labels), parts.names, parts.colors)


def subjects(objects: list[bpy.types.Object], depsgraph: bpy.types.Depsgraph, with_modifiers: bool) -> list[Subject]:
    """The meshes of some objects; a mesh that several objects have is one subject.

    Raises
    ------
    CleaveError
        If there are none, or if a mesh cannot be changed or has no faces.
    """
    of_mesh: dict[str, list[bpy.types.Object]] = {}
    for entry in objects:
        if entry.type == "MESH":
            of_mesh.setdefault(entry.data.name_full, []).append(entry)
    if not of_mesh:
        raise CleaveError("Select an object with a mesh.")
    return [_subject(sharing, depsgraph, with_modifiers) for sharing in of_mesh.values()]


def _subject(objects: list[bpy.types.Object], depsgraph: bpy.types.Depsgraph, with_modifiers: bool) -> Subject:
    entry = objects[0]
    if not entry.data.is_editable:
        raise CleaveError(f"{entry.name} is linked from another file: make its mesh local first.")
    if not entry.data.polygons:
        raise CleaveError(f"{entry.name} has no faces: deselect it.")
    note = None
    vertices = _vertices(entry.data)
    if with_modifiers and (entry.modifiers or entry.data.shape_keys):
        evaluated = entry.evaluated_get(depsgraph)
        shown = evaluated.to_mesh()
        if _topology(shown) == _topology(entry.data):
            vertices = _vertices(shown)
        else:
            note = f"{entry.name}: modifiers change its faces, so the parts are those of the mesh without modifiers."
        evaluated.to_mesh_clear()
    stretch = shape_matrix(np.array(entry.matrix_world.to_3x3(), dtype=np.float64))
    if stretch is not None:
        vertices = (vertices @ stretch.T).astype(np.float32)
    if not np.isfinite(vertices).all():
        raise CleaveError(f"{entry.name} has vertices at infinity: correct them first.")
    polygons = Polygons(vertices, *polygon_corners(entry.data))
    ply = polygons.ply()
    return Subject(objects, polygons, ply, digest(ply), _topology(entry.data), note)


def _vertices(mesh: bpy.types.Mesh) -> FloatArray:
    values = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    mesh.vertices.foreach_get("co", values)
    return values.reshape(-1, 3)


def polygon_corners(mesh: bpy.types.Mesh) -> tuple[IntArray, IntArray]:
    """The vertices of all polygons, concatenated, and the number of corners of each."""
    corners, sizes = np.empty(len(mesh.loops), dtype=np.int32), np.empty(len(mesh.polygons), dtype=np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    mesh.polygons.foreach_get("loop_total", sizes)
    return corners, sizes


def _topology(mesh: bpy.types.Mesh) -> str:
    return digest(*(array.tobytes() for array in polygon_corners(mesh)))
