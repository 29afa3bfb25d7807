"""Models that Blender makes: n-gons, modifiers, shape keys, loose edges; run inside Blender."""

import math

import bpy


def five_models() -> list[bpy.types.Object]:
    """A table of n-gons, a bent dumbbell, a subdivided head, a stretched star of triangles, a stool with shape keys."""
    for entry in list(bpy.data.objects):
        bpy.data.objects.remove(entry)
    return [table(), bent_dumbbell(), subdivided_head(), stretched_star(), stool_with_keys()]


def table() -> bpy.types.Object:
    """A board and four round legs with n-gons, turned and moved; the legs differ, so that labels have an order."""
    parts = [_cube((0, 0, 1.1), (2.4, 1.4, 0.2))]
    corners = [(x, y) for x in (-1, 1) for y in (-0.5, 0.5)]
    parts += [_rod((x, y, 0.5), 0.12 + 0.02 * leg, 1.0) for leg, (x, y) in enumerate(corners)]
    made = _joined("table", parts)
    made.rotation_euler, made.location = (0.3, 0.2, 1.0), (5, 0, 0)
    return made


def bent_dumbbell() -> bpy.types.Object:
    """Two balls on a rod, bent by a modifier that keeps the faces."""
    made = _joined("dumbbell", [_ball((-2, 0, 0)), _ball((2, 0, 0)), _rod((0, 0, 0), 0.3, 3.6, turn=True)])
    bend = made.modifiers.new("bend", "SIMPLE_DEFORM")
    bend.deform_method, bend.deform_axis, bend.angle = "BEND", "Z", math.radians(80)
    return made


def subdivided_head() -> bpy.types.Object:
    """Blender's monkey with a modifier that changes the faces."""
    bpy.ops.mesh.primitive_monkey_add(location=(0, 5, 0))
    bpy.context.object.name = "head"
    bpy.context.object.modifiers.new("finer", "SUBSURF")
    return bpy.context.object


def stretched_star() -> bpy.types.Object:
    """Triangles: a ball with three cones, stretched along an axis and mirrored."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3)
    parts = [bpy.context.object]
    for turn in range(3):
        angle = 2 * math.pi * turn / 3
        bpy.ops.mesh.primitive_cone_add(
            radius1=0.4,
            depth=2 + 0.3 * turn,
            end_fill_type="TRIFAN",
            location=(1.5 * math.cos(angle), 1.5 * math.sin(angle), 0),
        )
        bpy.context.object.rotation_euler = (0, math.pi / 2, angle)
        parts.append(bpy.context.object)
    made = _joined("star", parts)
    made.scale = (-1, 1, 2.5)
    return made


def stool_with_keys() -> bpy.types.Object:
    """A seat on three legs, with a shape key that makes it taller and an edge without a face."""
    legs = [_rod((math.cos(a), math.sin(a), 0), 0.15, 2.0) for a in (0.0, 2.1, 4.2)]
    made = _joined("stool", [_rod((0, 0, 1.15), 1.4, 0.3), *legs])
    mesh = made.data
    loose = len(mesh.vertices)
    mesh.vertices.add(2)
    mesh.vertices[loose].co = (0, 0, 3)
    mesh.vertices[loose + 1].co = (0, 0, 4)
    mesh.edges.add(1)
    mesh.edges[len(mesh.edges) - 1].vertices = (loose, loose + 1)
    mesh.update()
    made.shape_key_add(name="Basis")
    taller = made.shape_key_add(name="taller")
    for point in taller.data:
        point.co.z *= 1.5
    taller.value = 1.0
    return made


def _cube(place: tuple[float, float, float], size: tuple[float, float, float]) -> bpy.types.Object:
    bpy.ops.mesh.primitive_cube_add(size=1, location=place, scale=size)
    return bpy.context.object


def _ball(place: tuple[float, float, float]) -> bpy.types.Object:
    bpy.ops.mesh.primitive_uv_sphere_add(segments=24, ring_count=12, location=place)
    return bpy.context.object


def _rod(place: tuple[float, float, float], radius: float, length: float, turn: bool = False) -> bpy.types.Object:
    rotation = (0, math.pi / 2, 0) if turn else (0, 0, 0)
    bpy.ops.mesh.primitive_cylinder_add(
        vertices=20, radius=radius, depth=length, location=place, rotation=rotation, end_fill_type="NGON"
    )
    return bpy.context.object


def _joined(name: str, parts: list[bpy.types.Object]) -> bpy.types.Object:
    bpy.ops.object.select_all(action="DESELECT")
    for part in parts:
        part.select_set(True)
    bpy.context.view_layer.objects.active = parts[0]
    bpy.ops.object.join()
    bpy.ops.object.transform_apply()
    parts[0].name = parts[0].data.name = name
    return parts[0]
