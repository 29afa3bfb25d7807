"""A robot on a floor in MuJoCo: whether it stands still."""

from __future__ import annotations

import io
import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import ConvexHull, QhullError

if TYPE_CHECKING:
    from segcore.arrays import FloatArray
    from segcore.robots.plan import RobotPlan

_SECONDS = 2.0
_SOLE = 0.001  # of the longest side: collision pieces below this height carry the robot


@dataclass(frozen=True, slots=True)
class Standing:
    """What was found of a robot after two seconds on the floor."""

    urdf_mass: float  # kg, of the robot as MuJoCo reads its URDF
    mass: float  # kg, as it reads its MJCF
    speed: float  # m/s and rad/s, the largest of any degree of freedom
    moved: float  # of the origin of any link, over the longest side
    contacts: int


def stand(plan: RobotPlan, folder: Path) -> Standing:
    """Write a robot into a folder, load both files, and simulate the scene."""
    import mujoco

    from segcore.robots.writer import write_robot

    target = io.BytesIO()
    write_robot(target, plan)
    zipfile.ZipFile(target).extractall(folder)
    urdf = mujoco.MjModel.from_xml_path(str(folder / "robot.urdf"))
    model = mujoco.MjModel.from_xml_path(str(folder / "scene.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    places = data.xpos.copy()
    while data.time < _SECONDS:
        mujoco.mj_step(model, data)
    return Standing(
        urdf_mass=float(urdf.body_mass.sum()),
        mass=float(model.body_mass.sum()),
        speed=float(np.abs(data.qvel).max()),
        moved=float(np.linalg.norm(data.xpos - places, axis=1).max()) / _extent(plan),
        contacts=int(data.ncon),
    )


def is_balanced(plan: RobotPlan) -> bool:
    """Whether the centre of mass is above the convex hull of what touches the floor."""
    found = [link.body.properties for link in plan.links if link.body.properties]
    centre = np.average([one.centre for one in found], axis=0, weights=[one.mass for one in found])
    points = _points(plan)
    sole = points[points[:, 2] <= points[:, 2].min() + _SOLE * _extent(plan), :2]
    try:
        return bool((ConvexHull(sole).equations @ np.append(centre[:2], 1.0) <= 0).all())
    except (QhullError, ValueError):
        return False  # it stands on an edge or a corner


def _points(plan: RobotPlan) -> FloatArray:
    return np.concatenate([piece.vertices for link in plan.links for piece in link.body.pieces])


def _extent(plan: RobotPlan) -> float:
    return float(np.ptp(_points(plan), axis=0).max())
