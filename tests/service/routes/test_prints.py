"""Files for printing and their reports."""

import io
import sys
import zipfile
from collections.abc import Callable

import httpx
import pytest

from helpers.api import problem
from helpers.printing.bars import bar
from segcore import Mesh
from segcore.io import write_mesh
from segcore.printing import plan
from segcore.printing.plan import plan_print
from service.printing.documents import PrintDocument


@pytest.fixture
def path(finished_job: Callable[..., str]) -> str:
    """The path of a job of a bar of 60 mm, which is named in millimetres with z up."""
    target = io.BytesIO()
    write_mesh(target, bar()[0], "off")
    return finished_job(target.getvalue(), unit="mm", up="z")


def test_the_report_says_what_the_file_contains(client: httpx.Client, path: str) -> None:
    query = {"segments": 1, "bed": "50x50x50", "connectors": "dowel", "clearance": 0.4, "name": "0:arm", "slots": 2}
    answer = client.get(f"{path}/print.json", params=query)
    report = PrintDocument.model_validate_json(answer.content)
    assert set(answer.json()) == set(PrintDocument.model_fields)
    assert report.unit_of_mesh == "millimeter"
    assert [one.name for one in report.objects] == ["arm 1", "arm 2", "dowel 1"]
    (contact,) = report.contacts
    assert contact.connector is not None
    assert contact.connector.hole_diameter == pytest.approx(contact.connector.diameter + 0.4, abs=0.01)
    model = client.get(f"{path}/print.3mf", params={**query, "slicer": "prusa"})
    assert (model.headers["Content-Type"], model.status_code) == ("model/3mf", 200)
    archive = zipfile.ZipFile(io.BytesIO(model.content))
    assert archive.read("3D/3dmodel.model").count(b"<object ") == 3
    assert "Metadata/Slic3r_PE_model.config" in archive.namelist()
    again = client.get(f"{path}/print.json", params=query, headers={"If-None-Match": answer.headers["ETag"]})
    assert again.status_code == 304


def test_a_file_and_its_report_are_planned_once(
    client: httpx.Client, path: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    plans = []
    monkeypatch.setattr(plan, "plan_print", lambda *a, **k: plans.append(plan_print(*a, **k)) or plans[-1])
    assert client.get(f"{path}/print.3mf?segments=1").status_code == 200
    report = client.get(f"{path}/print.json?segments=1").json()
    assert len(plans) == 1
    assert report == client.get(f"{path}/print.json?segments=1&clearance=0.2").json()
    assert client.get(f"{path}/print.json?segments=2").json() != report
    assert len(plans) == 2


@pytest.mark.parametrize(("said", "up", "tall"), [(None, None, 20.0), (None, "y", 60.0), ("z", "y", 20.0)])
def test_the_axis_that_points_up_can_be_said_if_the_mesh_does_not_name_it(
    client: httpx.Client, finished_job: Callable[..., str], said: str | None, up: str | None, tall: float
) -> None:
    mesh, target = bar()[0], io.BytesIO()
    write_mesh(target, Mesh(mesh.vertices[:, [1, 0, 2]], mesh.faces[:, ::-1]), "off")  # long along y
    path = finished_job(target.getvalue(), unit="mm", **({"up": said} if said else {}))
    query = {"segments": 1, **({"up": up} if up else {})}
    (only,) = client.get(f"{path}/print.json", params=query).json()["objects"]
    assert only["size"][2] == pytest.approx(tall)


@pytest.mark.parametrize(
    ("query", "code"),
    [
        ("bed=100x100", "invalid_request"),
        ("bed=10x100x100", "invalid_parameters"),
        ("clearance=nan", "invalid_request"),
        ("slots=0", "invalid_request"),
        ("connectors=screws", "invalid_request"),
        ("segments=99", "invalid_parameters"),
        ("connector=peg", "invalid_request"),
        ("up=x", "invalid_request"),
    ],
)
def test_values_that_do_not_exist_are_refused(client: httpx.Client, path: str, query: str, code: str) -> None:
    problem(client.get(f"{path}/print.3mf?{query}"), 422, code)


def test_a_missing_package_is_named(client: httpx.Client, path: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "manifold3d", None)
    assert "cleave-mesh[print]" in problem(client.get(f"{path}/print.3mf"), 501, "missing_package")["detail"]
