"""The operator that segments the selected objects."""

from collections.abc import Mapping
from functools import partial

import bpy

from ..parts import Parts, unnamed
from ..results import Segmented, segmented_here, segmented_on
from ..scene.reading import Subject
from ..scene.record import keep
from ..work import Solve
from .computing import RESULTS, Computing
from .preferences import local_python, preferences, server


class SegmentOperator(Computing, bpy.types.Operator):
    """Find the parts of the selected objects"""

    bl_idname = "object.cleave_segment"
    bl_label = "Find Parts"
    bl_options = {"REGISTER", "UNDO"}

    level: bpy.props.EnumProperty(
        name="Level",
        items=[
            ("AUTOMATIC", "Automatic", "The number of parts that Cleave recommends for each mesh"),
            ("NUMBER", "Number", "A number of parts, the same for each mesh"),
            ("GRANULARITY", "Granularity", "From coarse to fine, for each mesh in its own range"),
        ],
    )
    segments: bpy.props.IntProperty(name="Parts", description="The number of parts", default=8, min=1, soft_max=64)
    granularity: bpy.props.FloatProperty(
        name="Granularity",
        description="0 is one part, 0.5 the recommended number, 1 as many parts as possible",
        default=0.5,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
    )
    with_modifiers: bpy.props.BoolProperty(
        name="With Modifiers",
        description="Segment the shape that modifiers and shape keys give, if they do not change the faces",
        default=True,
    )

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        layout.prop(self, "level")
        if self.level != "AUTOMATIC":
            layout.prop(self, "segments" if self.level == "NUMBER" else "granularity", slider=True)
        layout.prop(self, "with_modifiers")
        self.draw_outputs()

    def tasks(self, context: bpy.types.Context, found: list[Subject]) -> Mapping[str, Solve]:
        chosen = preferences(context)
        if chosen.place == "LOCAL":
            solve = partial(segmented_here, local_python(chosen))
        else:
            solve = partial(segmented_on, server(chosen))
        keyed = {self._key(context, subject): subject for subject in found}
        return {
            key: partial(solve, subject.ply, subject.polygons.triangle_count, subject.name)
            for key, subject in keyed.items()
            if key not in RESULTS
        }

    def parts(self, context: bpy.types.Context, subject: Subject) -> Parts:
        result: Segmented = RESULTS[self._key(context, subject)]
        levels = result.levels
        segments = {
            "AUTOMATIC": levels.automatic,
            "NUMBER": min(self.segments, levels.most),
            "GRANULARITY": levels.segments_at(self.granularity),
        }[self.level]
        if self.level == "NUMBER" and self.segments > levels.most:
            self.report({"WARNING"}, f"{subject.name} has no more than {levels.most} parts")
        if self.level != "NUMBER":
            self.segments = segments  # where the slider begins
        if result.job:
            keep(subject.mesh, job=result.job, server=result.server, topology=subject.topology)
        return unnamed(levels.labels(segments), segments)

    @staticmethod
    def _key(context: bpy.types.Context, subject: Subject) -> str:
        chosen = preferences(context)
        place = chosen.python if chosen.place == "LOCAL" else chosen.server
        return f"{chosen.place} {place} {subject.digest}"
