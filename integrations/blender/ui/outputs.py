"""The properties of operators that say what is made of the parts."""

import bpy
import numpy as np

from ..parts import Parts
from ..scene.outputs import write_attribute, write_face_sets, write_groups, write_materials
from ..scene.reading import Subject
from ..scene.separation import separate


class Outputs:
    """What is made of the parts of each mesh."""

    face_sets: bpy.props.BoolProperty(name="Face Sets", description="For sculpting", default=True)
    attribute: bpy.props.BoolProperty(
        name="Attribute", description="The number of the part of each face, counted from 0", default=True
    )
    materials: bpy.props.BoolProperty(
        name="Materials", description="A material for each part, in place of those of the faces", default=True
    )
    groups: bpy.props.BoolProperty(name="Vertex Groups", description="A vertex group for each part", default=False)
    separate: bpy.props.BoolProperty(name="Separate Objects", description="An object for each part", default=False)

    def draw_outputs(self) -> None:
        column = self.layout.column(heading="Make")
        for name in ("face_sets", "attribute", "materials", "groups", "separate"):
            column.prop(self, name)

    def write(self, subject: Subject, of_triangles: Parts) -> int:
        """Write the chosen outputs; return the number of parts that have polygons."""
        parts = subject.of_polygons(of_triangles)
        if self.face_sets:
            write_face_sets(subject.mesh, parts)
        if self.attribute:
            write_attribute(subject.mesh, parts)
        if self.materials:
            write_materials(subject.mesh, parts)
        if self.groups:
            write_groups(subject.objects[0], parts)
        if self.separate:
            for entry in subject.objects:
                separate(entry, parts)
        return len(np.unique(parts.labels))
