"""Models that keep everything of the file that was sent: model.glb?keep=all and parts.zip?part_format=glb."""

import io
import zipfile
from collections.abc import Callable
from pathlib import Path

import httpx
import numpy as np
import pytest

from cleave.settings import Settings
from helpers.api import AGAIN, problem
from helpers.files.kept import Opened, in_any_order, kept
from helpers.files.rich_gltf import BLUE, RED, rich_asset
from segcore.io import read_mesh, read_result
from worker.jobs.store.store import JobStore
from worker.process.perform import perform

RICH = rich_asset().glb()
OBJ = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nusemtl red\nf 1/1 3/1 2/1\nf 1/1 2/1 4/1\n"


@pytest.fixture
def rich_job(client: httpx.Client, settings: Settings, store: JobStore) -> str:
    """The path of a finished job of the asset that has everything."""
    answer = client.post("/v1/jobs", files={"mesh": ("rich.glb", RICH)}, headers=AGAIN)
    perform(store, settings, answer.json()["id"], lambda *_: None)
    return str(answer.headers["Location"])


def stored_file(settings: Settings, content: bytes) -> Path:
    """The one file of the store with this content."""
    (found,) = (path for path in settings.data_dir.rglob("*") if path.is_file() and path.read_bytes() == content)
    return found


def test_the_model_is_the_input_divided_by_part(client: httpx.Client, rich_job: str) -> None:
    answer = client.get(f"{rich_job}/model.glb", params={"keep": "all", "segments": 2, "name": "1:wheel"})
    assert answer.headers["Content-Type"] == "model/gltf-binary"
    hierarchy = read_result(io.BytesIO(client.get(f"{rich_job}/result.cleave").content)).hierarchy
    assert answer.content == kept(RICH, hierarchy, 2, names={1: "wheel"})
    opened = Opened(answer.content)
    assert [opened.picture(0), opened.picture(1)] == [RED, BLUE]
    mesh, labels = read_mesh(io.BytesIO(RICH)), hierarchy.labels(2)
    for part, corners in opened.corners_by_part().items():
        assert in_any_order(corners) == in_any_order(mesh.corners[labels == part])


def test_the_kept_model_has_a_tag_of_its_own(client: httpx.Client, rich_job: str) -> None:
    urls = [f"{rich_job}/model.glb{query}" for query in ("", "?keep=all", "?keep=all&levels=all", "?layout=flat")]
    answers = [client.get(url) for url in urls]
    assert len({answer.headers["ETag"] for answer in answers}) == len({answer.content for answer in answers}) == 4
    tag = answers[1].headers["ETag"]
    assert client.get(urls[1], headers={"If-None-Match": tag}).status_code == 304


def test_parts_as_glb_have_what_they_need(client: httpx.Client, rich_job: str) -> None:
    data = client.get(f"{rich_job}/parts.zip", params={"segments": 2, "part_format": "glb"}).content
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        parts = [Opened(archive.read(name)) for name in archive.namelist()]
    pictures = {part.picture(i) for part in parts for i in range(len(part.document.get("images", [])))}
    assert pictures == {RED, BLUE}
    problem(client.get(f"{rich_job}/parts.zip?part_format=obj&keep=all"), 422, "invalid_parameters")
    problem(client.get(f"{rich_job}/model.glb?keep=some"), 422, "invalid_request")
    problem(client.get(f"{rich_job}/model.glb?keep=all&layout=flat"), 422, "invalid_parameters")


def test_an_input_that_the_store_has_lost_is_a_clear_problem(
    client: httpx.Client, settings: Settings, rich_job: str
) -> None:
    stored_file(settings, RICH).unlink()
    for result in ("model.glb?keep=all", "parts.zip?part_format=glb"):
        assert "submit it again" in str(problem(client.get(f"{rich_job}/{result}"), 410, "input_lost")["detail"])
    assert client.get(f"{rich_job}/model.glb").status_code == 200


@pytest.mark.parametrize("change", ["other faces", "damaged"])
def test_an_input_that_is_read_in_another_way_is_never_given_wrong_labels(
    client: httpx.Client, settings: Settings, rich_job: str, change: str
) -> None:
    asset = rich_asset()
    if change == "other faces":
        asset.document["scenes"][0]["nodes"].reverse()
    path = stored_file(settings, RICH)
    path.chmod(0o600)
    path.write_bytes(asset.glb() if change == "other faces" else RICH[:-99])
    problem(client.get(f"{rich_job}/model.glb?keep=all"), 422, "input_changed")


def test_a_mesh_of_another_format_is_kept_as_glb(client: httpx.Client, finished_job: Callable[..., str]) -> None:
    path = finished_job()
    opened = Opened(client.get(f"{path}/model.glb", params={"keep": "all", "segments": 3}).content)
    result = read_result(io.BytesIO(client.get(f"{path}/result.cleave").content))
    for part, corners in opened.corners_by_part().items():
        expected = result.mesh.corners[result.hierarchy.labels(3) == part]
        np.testing.assert_allclose(in_any_order(corners), in_any_order(expected), atol=1e-6)


def test_an_archive_of_obj_with_its_materials_keeps_its_pictures(
    client: httpx.Client, settings: Settings, store: JobStore
) -> None:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        archive.writestr("model/a.obj", OBJ)
        archive.writestr("model/a.mtl", "newmtl red\nmap_Kd pictures/red.png\n")
        archive.writestr("model/pictures/red.png", RED)
    answer = client.post("/v1/jobs", files={"mesh": ("model.zip", packed.getvalue())}, headers=AGAIN)
    perform(store, settings, answer.json()["id"], lambda *_: None)
    kept_model = Opened(client.get(f"{answer.headers['Location']}/model.glb?keep=all").content)
    assert kept_model.picture(0) == RED
    assert kept_model.document["materials"][0]["name"] == "red"
