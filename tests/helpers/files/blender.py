"""Write the parts that Blender reads from the files listed on standard input as JSON to the file in the first argument.

{path: [{"name": str, "corners": [x, y, z, ...]}, ...]}, a part for each object, in the coordinates of the file.
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
    ".stl": lambda path: bpy.ops.wm.stl_import(filepath=path, use_mesh_validate=False, **_AXES),
}


def parts(path: str) -> list[dict]:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    _READERS[Path(path).suffix](path)
    bpy.context.view_layer.update()
    return [
        {"name": entry.name, "corners": corners(entry, path.endswith(".glb")).ravel().tolist()}
        for entry in bpy.data.objects
        if entry.type == "MESH"
    ]


def corners(entry: bpy.types.Object, is_gltf: bool) -> np.ndarray:
    """(C, 3) corners; y is up in glTF and z in Blender."""
    points = np.array([entry.matrix_world @ vertex.co for vertex in entry.data.vertices])
    points = np.stack([points[:, 0], points[:, 2], -points[:, 1]], axis=1) if is_gltf else points
    return points[[vertex for polygon in entry.data.polygons for vertex in polygon.vertices]]


Path(sys.argv[1]).write_text(json.dumps({path: parts(path) for path in json.load(sys.stdin)}))
