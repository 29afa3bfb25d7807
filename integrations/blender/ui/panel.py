"""The panel in the sidebar of the 3D view."""

import bpy

from ..scene.record import record
from .fetching import FetchOperator
from .preferences import preferences
from .segmenting import SegmentOperator


class CleavePanel(bpy.types.Panel):
    bl_idname = "CLEAVE_PT_parts"
    bl_label = "Cleave"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Cleave"

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        chosen = preferences(context)
        layout.prop(chosen, "place", text="")
        layout.operator(SegmentOperator.bl_idname, icon="MOD_EXPLODE")
        if chosen.place == "SERVER":
            self._draw_corrections(context)

    def _draw_corrections(self, context: bpy.types.Context) -> None:
        active = context.active_object
        known = record(active.data) if active is not None and active.type == "MESH" else {}
        if "job" not in known:
            return
        column = self.layout.column()
        column.operator(
            "wm.url_open", text="Correct on the Page", icon="URL"
        ).url = f"{known['server']}/#job={known['job']}"
        column.operator(FetchOperator.bl_idname, icon="IMPORT")
