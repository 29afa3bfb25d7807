"""Robots, and what they consist of."""

import io
import sys
import zipfile
from collections.abc import Callable

import httpx
import pytest

from helpers.api import problem
from helpers.printing.bars import bar
from segcore.io import write_mesh
from service.robots.documents import LinkDocument, RobotDocument


@pytest.fixture
def path(finished_job: Callable[..., str]) -> str:
    """The path of a job of a bar of 60 mm, which is named in millimetres with z up."""
    target = io.BytesIO()
    write_mesh(target, bar()[0], "off")
    return finished_job(target.getvalue(), unit="mm", up="z")


def test_the_report_says_what_the_archive_contains(client: httpx.Client, path: str) -> None:
    query = {"segments": 1, "density": 500, "name": "0:upper arm", "length": 0.6, "joints": "hinge"}
    answer = client.get(f"{path}/robot.json", params=query)
    report = RobotDocument.model_validate_json(answer.content)
    assert set(answer.json()) == set(RobotDocument.model_fields)
    assert set(answer.json()["links"][0]) == set(LinkDocument.model_fields)
    assert report.unit_of_mesh == "millimeter"
    assert [(link.link, link.name, link.joint) for link in report.links] == [("upper_arm", "upper arm", None)]
    assert report.mass == pytest.approx(500 * 0.6 * 0.2 * 0.2)
    robot = client.get(f"{path}/robot.zip", params=query)
    assert (robot.headers["Content-Type"], robot.status_code) == ("application/zip", 200)
    archive = zipfile.ZipFile(io.BytesIO(robot.content))
    assert archive.namelist()[:4] == ["robot.urdf", "robot.xml", "scene.xml", "robot.json"]
    assert archive.read("robot.json").decode() == answer.text
    again = client.get(f"{path}/robot.json", params=query, headers={"If-None-Match": answer.headers["ETag"]})
    assert again.status_code == 304


@pytest.mark.parametrize(
    ("query", "code"),
    [
        ("joints=ball", "invalid_request"),
        ("density=0", "invalid_request"),
        ("concavity=nan", "invalid_request"),
        ("pieces=65", "invalid_request"),
        ("segments=99", "invalid_parameters"),
        ("size=2", "invalid_request"),
    ],
)
def test_values_that_do_not_exist_are_refused(client: httpx.Client, path: str, query: str, code: str) -> None:
    problem(client.get(f"{path}/robot.zip?{query}"), 422, code)


@pytest.mark.parametrize("kind", ["usdc", "usdz"])
def test_usd_has_the_names_and_the_level(client: httpx.Client, path: str, kind: str) -> None:
    answer = client.get(f"{path}/model.{kind}", params={"segments": 1, "name": "0:arm"})
    assert answer.status_code == 200
    assert answer.content.startswith({"usdc": b"PXR-USDC", "usdz": b"PK"}[kind])
    assert f'.{kind}"' in answer.headers["Content-Disposition"]


def test_missing_packages_are_named(
    client: httpx.Client, finished_job: Callable[..., str], monkeypatch: pytest.MonkeyPatch
) -> None:
    path = finished_job()  # of parts that are not convex
    for name in [name for name in sys.modules if name.partition(".")[0] == "pxr"]:
        monkeypatch.delitem(sys.modules, name)
    for name in ("coacd", "pxr"):
        monkeypatch.setitem(sys.modules, name, None)
    assert "cleave-mesh[robot]" in problem(client.get(f"{path}/robot.zip"), 501, "missing_package")["detail"]
    assert "cleave-mesh[usd]" in problem(client.get(f"{path}/model.usdz"), 501, "missing_package")["detail"]
    assert client.get(f"{path}/robot.zip?collision=hull").status_code == 200
