"""The steps of a job on a real service."""

import io
import json

import httpx
import numpy as np
import pytest

import segcore
from integrations.blender.errors import CanceledError, CleaveError
from integrations.blender.polygons import Polygons
from integrations.blender.server import Server
from integrations.blender.work import Watch
from segcore.shapes import burr

_MESH = burr(3).mesh
_SIZES = np.full(len(_MESH.faces), 3, dtype=np.int32)
_PLY = Polygons(_MESH.vertices.astype(np.float32), _MESH.faces.ravel(), _SIZES).ply()


def client(url: str, api_key: str) -> httpx.Client:
    return httpx.Client(base_url=url, headers={"Authorization": f"Bearer {api_key}"})


@pytest.fixture
def http(url: str, api_key: str) -> httpx.Client:
    return client(url, api_key)


def test_the_levels_are_those_of_the_api(url: str, api_key: str, http: httpx.Client) -> None:
    watch = Watch(60)
    job = Server(url, api_key).segment(_PLY, len(_MESH.faces), "burr & co", watch)
    assert watch.state == "fetching the parts of burr & co"
    with http:
        document = http.get(f"/v1/jobs/{job.id}").json()
        assert document["input"]["file_name"] == "burr & co.ply"
        assert job.levels.automatic == document["automatic_segments"]
        for segments in (1, 3, document["automatic_segments"], document["max_segments"]):
            labels = http.get(f"/v1/jobs/{job.id}/labels", params={"segments": segments}).json()["labels"]
            assert job.levels.labels(segments).tolist() == labels


def test_the_newest_revision_has_names_and_colors(url: str, api_key: str, http: httpx.Client) -> None:
    server = Server(url, api_key)
    job = server.segment(_PLY, len(_MESH.faces), "burr", Watch(60))
    with pytest.raises(CleaveError, match="were not corrected on the server"):
        server.newest_revision(job.id, len(_MESH.faces), Watch(60))
    edit = {
        "base": 0,
        "level": {"segments": 4},
        "operations": [{"op": "merge", "parts": [1, 2]}, {"op": "name", "part": 0, "name": "body"}],
    }
    with http:
        made = http.post(f"/v1/jobs/{job.id}/edits", content=json.dumps(edit))
        assert made.status_code == 201, made.text
        expected = http.get(f"/v1/jobs/{job.id}/labels", params={"revision": "latest"}).json()
    found = server.newest_revision(job.id, len(_MESH.faces), Watch(60))
    assert found.labels.tolist() == expected["labels"]
    assert found.parts == [(part["name"], part["color"]) for part in expected["parts"]]
    assert found.parts[0][0] == "body"
    with pytest.raises(CleaveError, match="but the mesh has 5: segment it again"):
        server.newest_revision(job.id, 5, Watch(60))


def test_a_wrong_key_is_refused_with_what_to_do(url: str) -> None:
    for key in ("", "cleave_wrong"):
        with pytest.raises(CleaveError, match="Enter the key in the preferences"):
            Server(url, key).segment(_PLY, len(_MESH.faces), "burr", Watch(60))


def test_a_mesh_that_cannot_be_segmented_is_named(url: str, api_key: str) -> None:
    flat = Polygons(np.zeros((3, 3), dtype=np.float32), np.int32([0, 1, 9]), np.int32([3])).ply()
    with pytest.raises(CleaveError, match=r"^flat: .*vert") as caught:
        Server(url, api_key).segment(flat, 1, "flat", Watch(60))
    with pytest.raises(segcore.InvalidMesh) as invalid:
        segcore.read_mesh(io.BytesIO(flat), "ply")
    assert str(caught.value) == f"flat: {invalid.value}"


def test_stopped_work_cancels_its_job(idle_url: str, api_key: str) -> None:
    class Stopped(Watch):
        """Stops as soon as the job waits."""

        def check(self) -> float:
            if self.state == "burr waits, place 1":
                self.stop()
            return super().check()

    with pytest.raises(CanceledError):
        Server(idle_url, api_key).segment(_PLY, len(_MESH.faces), "burr", Stopped(60))
    with client(idle_url, api_key) as http:
        (job,) = http.get("/v1/jobs").json()["jobs"]
        assert job["status"] == "canceled"
