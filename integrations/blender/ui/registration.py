"""What the extension adds to Blender, and takes away again."""

import bpy

from .computing import RESULTS
from .fetching import FetchOperator
from .panel import CleavePanel
from .preferences import CleavePreferences
from .segmenting import SegmentOperator

_CLASSES = (CleavePreferences, SegmentOperator, FetchOperator, CleavePanel)


def register_classes() -> None:
    for one in _CLASSES:
        bpy.utils.register_class(one)
    bpy.types.VIEW3D_MT_object.append(_draw_menu)


def unregister_classes() -> None:
    bpy.types.VIEW3D_MT_object.remove(_draw_menu)
    for one in reversed(_CLASSES):
        bpy.utils.unregister_class(one)
    RESULTS.clear()


def _draw_menu(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    menu.layout.separator()
    menu.layout.operator(SegmentOperator.bl_idname, text="Cleave: Find Parts")
