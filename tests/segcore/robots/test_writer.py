"""The files of a robot in MuJoCo: it loads them, and the robot stands."""

import io
import json
import zipfile
from pathlib import Path

import mujoco
import numpy as np
import pytest

from helpers.printing.bars import bar
from helpers.simulation.shapes import angle, table
from segcore.hierarchy import Hierarchy
from segcore.mesh import Mesh
from segcore.partition import Partition
from segcore.robots.options import RobotOptions
from segcore.robots.plan import plan_robot
from segcore.robots.writer import write_robot


def written(mesh: Mesh, hierarchy: Hierarchy, options: RobotOptions, **looks: object) -> bytes:
    target = io.BytesIO()
    write_robot(target, plan_robot(mesh, hierarchy, options=options, **looks))
    return target.getvalue()


def unpacked(folder: Path, *arguments: object, **looks: object) -> dict:
    """Write the files into a folder and return their report."""
    zipfile.ZipFile(io.BytesIO(written(*arguments, **looks))).extractall(folder)
    return json.loads((folder / "robot.json").read_text(encoding="utf-8"))


def test_a_table_stands_still(tmp_path: Path) -> None:
    report = unpacked(tmp_path, *table(), RobotOptions(density=600.0))
    assert report["mass"] == pytest.approx(600 * (0.1 + 4 * 0.007))
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "scene.xml"))
    assert model.body_mass.sum() == pytest.approx(report["mass"], rel=1e-6)
    data = mujoco.MjData(model)
    while data.time < 2.0:
        mujoco.mj_step(model, data)
    assert np.abs(data.qvel).max() < 1e-6
    assert np.abs(data.qpos - [0, 0, 0, 1, 0, 0, 0]).max() < 1e-3  # it sinks in until the floor carries it
    assert data.ncon >= 4


def test_the_urdf_has_the_same_links_and_masses(tmp_path: Path) -> None:
    report = unpacked(tmp_path, *table(), RobotOptions(), names={0: "plate <1>", 3: "плита"})
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "robot.urdf"))
    links = [mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_BODY, k) for k in range(1, model.nbody)]
    assert sorted(links) == sorted(link["link"] for link in report["links"])
    assert links[0] == "plate_1"
    assert model.body_mass[1:] == pytest.approx([link["mass"] for link in report["links"]], rel=1e-5)
    centres = [link["centre_of_mass"] for link in report["links"]]
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert data.xipos[1:] == pytest.approx(np.array(centres), abs=1e-5)


def test_a_part_that_is_one_face_is_a_link_without_a_mesh(tmp_path: Path) -> None:
    mesh, _ = table()
    labels = np.zeros(len(mesh.faces), dtype=np.int32)
    labels[0] = 1
    report = unpacked(tmp_path, mesh, Partition(labels).hierarchy(mesh), RobotOptions(collision="hull"))
    assert [link["mass"] for link in report["links"]][1] is None
    for file in ("scene.xml", "robot.urdf"):
        model = mujoco.MjModel.from_xml_path(str(tmp_path / file))
        assert model.body_mass.sum() == pytest.approx(report["mass"], rel=1e-5)


@pytest.mark.parametrize("file", ["scene.xml", "robot.urdf"])
def test_a_hinge_turns_about_its_axis(tmp_path: Path, file: str) -> None:
    report = unpacked(tmp_path, *bar(), RobotOptions(joints="hinge", length=1.0))
    (axis,) = [link["axis"] for link in report["links"] if link["axis"]]
    model = mujoco.MjModel.from_xml_path(str(tmp_path / file))
    (joint,) = np.flatnonzero(model.jnt_type == mujoco.mjtJoint.mjJNT_HINGE)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert data.xaxis[joint] == pytest.approx(axis)
    assert data.xanchor[joint] == pytest.approx(report["links"][1]["origin"], rel=1e-5)


def test_the_same_input_gives_the_same_bytes() -> None:
    assert written(*angle(), RobotOptions()) == written(*angle(), RobotOptions())
