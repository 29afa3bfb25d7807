"""MJCF, the format of MuJoCo.

References
----------
https://mujoco.readthedocs.io/en/stable/XMLreference.html
"""

from collections.abc import Iterator

from segcore.robots.plan import Link, RobotPlan
from segcore.robots.texts import collision_file, is_drawn, mesh_file, numbers

SCENE = """<mujoco model="scene">
<include file="robot.xml"/>
<visual><headlight diffuse="0.6 0.6 0.6" ambient="0.3 0.3 0.3"/></visual>
<worldbody>
<light pos="0 0 3" dir="0 0 -1" directional="true"/>
<geom name="floor" type="plane" size="0 0 0.05" rgba="0.8 0.8 0.8 1"/>
</worldbody>
</mujoco>
"""
_HEAD = """<mujoco model="robot">
<compiler angle="radian"/>
<option integrator="implicitfast"/>
<default>
<default class="visual"><geom type="mesh" mass="0" contype="0" conaffinity="0" group="2"/></default>
<default class="collision"><geom type="mesh" mass="0" group="3"/></default>
</default>
"""


def mjcf_document(plan: RobotPlan) -> str:
    """Return the document; files are relative to its folder. The root moves freely."""
    children: list[list[Link]] = [[] for _ in plan.links]
    for link in plan.links:
        if link.joint is not None:
            children[link.joint.parent].append(link)
    place = {link.name: k for k, link in enumerate(plan.links)}
    pieces: list[str] = [_HEAD, "<asset>\n", *_assets(plan), "</asset>\n<worldbody>\n"]
    waiting: list[Link | None] = [plan.links[0]]  # None ends a body
    while waiting:
        one = waiting.pop()
        if one is None:
            pieces.append("</body>\n")
        else:
            pieces += _body(plan, one)
            waiting += [None, *reversed(children[place[one.name]])]
    return "".join([*pieces, "</worldbody>\n", *_exclusions(plan), "</mujoco>\n"])


def _assets(plan: RobotPlan) -> Iterator[str]:
    for link in plan.links:
        if is_drawn(link):
            yield f'<mesh name="{link.name}" file="{mesh_file(link)}" inertia="shell"/>\n'
        for k in range(len(link.body.pieces)):
            file = collision_file(link, k)
            yield f'<mesh name="{file.removesuffix(".obj")}" file="{file}" inertia="shell"/>\n'


def _body(plan: RobotPlan, link: Link) -> Iterator[str]:
    joint, properties = link.joint, link.body.properties
    parent = plan.links[joint.parent].origin if joint else link.origin
    yield f'<body name="{link.name}" pos="{numbers(link.origin - parent)}">\n'
    if joint is None:
        yield f'<freejoint name="{link.name}_joint"/>\n'
    elif joint.axis is not None:
        yield f'<joint name="{link.name}_joint" type="hinge" axis="{numbers(joint.axis)}"/>\n'
    if properties is not None:
        inertia = properties.inertia
        values = [inertia[k] for k in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
        yield (
            f'<inertial pos="{numbers(properties.centre - link.origin)}" mass="{numbers([properties.mass])}" '
            f'fullinertia="{numbers(values)}"/>\n'
        )
    if is_drawn(link):
        yield f'<geom class="visual" mesh="{link.name}" rgba="{numbers([*link.color, 1.0])}"/>\n'
    for k in range(len(link.body.pieces)):
        yield f'<geom class="collision" mesh="{collision_file(link, k).removesuffix(".obj")}"/>\n'


def _exclusions(plan: RobotPlan) -> Iterator[str]:
    """Yield that links with a common border do not collide: their convex pieces overlap there."""
    if all(link.joint is None or link.joint.axis is None for link in plan.links):
        return  # links that cannot move against each other do not collide
    yield "<contact>\n"
    for one, other in plan.touching:
        yield f'<exclude body1="{plan.links[one].name}" body2="{plan.links[other].name}"/>\n'
    yield "</contact>\n"
