"""The ZIP archive of a robot: URDF, MJCF, a scene for MuJoCo, meshes, and the report."""

import json
import zipfile
from typing import BinaryIO

from segcore.arrays import FloatArray
from segcore.io.archive import FAST, member
from segcore.io.obj.writer import encode_obj
from segcore.mesh import Mesh
from segcore.robots.masses import Solid
from segcore.robots.mjcf import SCENE, mjcf_document
from segcore.robots.plan import RobotPlan
from segcore.robots.report import robot_report
from segcore.robots.texts import collision_file, is_drawn, mesh_file
from segcore.robots.urdf import urdf_document

REPORT = "robot.json"


def write_robot(target: BinaryIO, plan: RobotPlan) -> None:
    """Write a plan as a ZIP archive.

    Its members are ``robot.urdf``, ``robot.xml`` (MJCF), ``scene.xml``, which puts the robot on a floor, ``robot.json``
    (the report), ``meshes/NAME.obj``, the part of a link, and ``collision/NAME_k.obj``, its convex pieces. Vertices are
    relative to the origin of their link.

    Parameters
    ----------
    target : a binary file; needs ``write`` and ``flush`` only.
    """
    report = json.dumps(robot_report(plan), ensure_ascii=False, indent=1)
    texts = {"robot.urdf": urdf_document(plan), "robot.xml": mjcf_document(plan), "scene.xml": SCENE, REPORT: report}
    with zipfile.ZipFile(target, "w", compresslevel=FAST) as archive:
        for name, text in texts.items():
            archive.writestr(member(name, compressed=True), text, compresslevel=FAST)
        for link in plan.links:
            if is_drawn(link):
                _write_mesh(archive, mesh_file(link), link.body.shape, link.origin)
            for k, piece in enumerate(link.body.pieces):
                _write_mesh(archive, collision_file(link, k), piece, link.origin)


def _write_mesh(archive: zipfile.ZipFile, name: str, solid: Solid, origin: FloatArray) -> None:
    with archive.open(member(name, compressed=True), "w", force_zip64=True) as file:
        file.writelines(encode_obj(Mesh(solid.vertices - origin, solid.faces)))
