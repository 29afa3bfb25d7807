"""Write the parts that Blender reads from the files listed on standard input as JSON to the file in the first argument.

{path: [{"name": str, "corners": [x, y, z, ...], "material": [r, g, b], "colors": [r, g, b, ...],
"attributes": {name: [...]}}, ...]}, a part for each object, in the coordinates of the file. The colour of the material
and those of the corners are null if there are none; the attributes are those of vertices that are whole numbers.
"""

import json
import sys
from pathlib import Path

import bpy
import numpy as np

_AXES = {"forward_axis": "Y", "up_axis": "Z"}  # as in the file
_READERS = {
    ".glb": lambda path: bpy.ops.import_scene.gltf(filepath=path),
    ".obj": lambda path: bpy.ops.wm.obj_import(
        filepath=path, use_split_groups=True, use_split_objects=True, validate_meshes=False, **_AXES
    ),
    ".ply": lambda path: bpy.ops.wm.ply_import(filepath=path, import_attributes=True, **_AXES),
    ".stl": lambda path: bpy.ops.wm.stl_import(filepath=path, use_mesh_validate=False, **_AXES),
}


def parts(path: str) -> list[dict]:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    _READERS[Path(path).suffix](path)
    bpy.context.view_layer.update()
    return [
        {
            "name": entry.name,
            "corners": corners(entry, path.endswith(".glb")).ravel().tolist(),
            "material": material(entry),
            "colors": colors(entry),
            "attributes": attributes(entry),
        }
        for entry in bpy.data.objects
        if entry.type == "MESH"
    ]


def corners(entry: bpy.types.Object, is_gltf: bool) -> np.ndarray:
    """(C, 3) corners; y is up in glTF and z in Blender."""
    points = np.array([entry.matrix_world @ vertex.co for vertex in entry.data.vertices])
    points = np.stack([points[:, 0], points[:, 2], -points[:, 1]], axis=1) if is_gltf else points
    return points[[vertex for polygon in entry.data.polygons for vertex in polygon.vertices]]


def material(entry: bpy.types.Object) -> list[float] | None:
    used = entry.material_slots[0].material if entry.material_slots else None
    shader = used.node_tree.nodes.get("Principled BSDF") if used and used.node_tree else None
    return list(shader.inputs["Base Color"].default_value)[:3] if shader else None


def colors(entry: bpy.types.Object) -> list[float] | None:
    """The colour of every corner, in sRGB, as it is shown."""
    shown = entry.data.color_attributes.active_color
    if shown is None:
        return None
    of_rows = [list(row.color_srgb)[:3] for row in shown.data]
    rows = [vertex for polygon in entry.data.polygons for vertex in polygon.vertices]
    return [channel for row in (rows if shown.domain == "POINT" else range(len(rows))) for channel in of_rows[row]]


def attributes(entry: bpy.types.Object) -> dict[str, list[float]]:
    kinds = ("INT", "FLOAT")
    return {
        one.name: [row.value for row in one.data]
        for one in entry.data.attributes
        if one.domain == "POINT" and one.data_type in kinds
    }


Path(sys.argv[1]).write_text(json.dumps({path: parts(path) for path in json.load(sys.stdin)}))
