"""URDF, the format of ROS and most simulators.

References
----------
https://wiki.ros.org/urdf/XML, and https://mujoco.readthedocs.io/en/stable/modeling.html#urdf-extensions
"""

from collections.abc import Iterator

from segcore.robots.plan import Link, RobotPlan
from segcore.robots.texts import collision_file, is_drawn, mesh_file, numbers

# MuJoCo otherwise drops folders from the names of files, and joins links at fixed joints.
_MUJOCO = '<mujoco><compiler strippath="false" fusestatic="false" discardvisual="false"/></mujoco>\n'


def urdf_document(plan: RobotPlan) -> str:
    """Return the document; files are relative to its folder."""
    links = "".join(text for link in plan.links for text in (*_link(link), *_joint(plan, link)))
    return f'<?xml version="1.0"?>\n<robot name="robot">\n{_MUJOCO}{links}</robot>\n'


def _link(link: Link) -> Iterator[str]:
    yield f'<link name="{link.name}">\n'
    properties = link.body.properties
    if properties is not None:
        inertia = properties.inertia
        places = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}
        values = " ".join(f'{name}="{numbers([inertia[place]])}"' for name, place in places.items())
        yield (
            f'<inertial><origin xyz="{numbers(properties.centre - link.origin)}" rpy="0 0 0"/>'
            f'<mass value="{numbers([properties.mass])}"/><inertia {values}/></inertial>\n'
        )
    if is_drawn(link):
        color = f'<material name="{link.name}"><color rgba="{numbers([*link.color, 1.0])}"/></material>'
        yield f'<visual><geometry><mesh filename="{mesh_file(link)}"/></geometry>{color}</visual>\n'
    for k in range(len(link.body.pieces)):
        yield f'<collision><geometry><mesh filename="{collision_file(link, k)}"/></geometry></collision>\n'
    yield "</link>\n"


def _joint(plan: RobotPlan, link: Link) -> Iterator[str]:
    joint = link.joint
    if joint is None:
        return
    parent = plan.links[joint.parent]
    kind, axis = ("fixed", "") if joint.axis is None else ("continuous", f'<axis xyz="{numbers(joint.axis)}"/>')
    yield (
        f'<joint name="{link.name}_joint" type="{kind}"><parent link="{parent.name}"/><child link="{link.name}"/>'
        f'<origin xyz="{numbers(link.origin - parent.origin)}" rpy="0 0 0"/>{axis}</joint>\n'
    )
