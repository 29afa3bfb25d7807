"""What there is in Blender, found without the extension; run inside Blender."""

import sys
from typing import Any

import bpy
import numpy as np

ADDON = "bl_ext.user_default.cleave_parts"


def attribute(mesh: bpy.types.Mesh, name: str = "cleave_part") -> list[int]:
    values = np.empty(len(mesh.polygons), dtype=np.int32)
    mesh.attributes[name].data.foreach_get("value", values)
    return values.tolist()


def select(*objects: bpy.types.Object) -> None:
    bpy.ops.object.select_all(action="DESELECT")
    for entry in objects:
        entry.select_set(True)
    bpy.context.view_layer.objects.active = objects[0] if objects else None


def refusal(operator: Any, **properties: Any) -> str:
    try:
        operator(**properties)
    except RuntimeError as error:
        return str(error).strip()
    return ""


def geometry(entry: bpy.types.Object, evaluated: bool) -> dict[str, Any]:
    """The polygons of an object, without the help of the extension."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    mesh = bpy.data.meshes.new_from_object(entry.evaluated_get(depsgraph) if evaluated else entry)
    if not evaluated:
        mesh = entry.data
    return {
        "vertices": [list(vertex.co) for vertex in mesh.vertices],
        "in the world": [list(entry.matrix_world @ vertex.co) for vertex in mesh.vertices],
        "polygons": [list(polygon.vertices) for polygon in mesh.polygons],
    }


def contents(entry: bpy.types.Object) -> dict[str, Any]:
    mesh = entry.data
    of_polygon = [polygon.material_index for polygon in mesh.polygons]
    slots = [slot.material for slot in entry.material_slots]
    return {
        "attributes": sorted(name for name in dict(mesh.attributes) if "cleave" in name or "face_set" in name),
        "materials": [material.name for material in slots],
        "material": of_polygon,
        "colors": [list(material.diffuse_color)[:3] for material in slots],
        "groups": {
            group.name: [
                vertex.index for vertex in mesh.vertices if group.index in [one.group for one in vertex.groups]
            ]
            for group in entry.vertex_groups
        },
        "record": mesh.get("cleave"),
    }


def registered() -> dict[str, Any]:
    """What Blender has of the extension."""
    return {
        "classes": sorted(name for name in dir(bpy.types) if "cleave" in name.lower()),
        "operators": sorted(name for name in dir(bpy.ops.object) if "cleave" in name),
        "menu": len(bpy.types.VIEW3D_MT_object._dyn_ui_initialize()),
        "preferences": [entry.module for entry in bpy.context.preferences.addons if "cleave" in entry.module],
        "modules": sorted(name for name in sys.modules if name.startswith(f"{ADDON}.")),
    }
