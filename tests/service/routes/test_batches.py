"""Batches: all or none, one status, one archive; and an archive that is sent is believed nothing."""

import io
import json
import struct
import zipfile
from pathlib import Path

import httpx
import pytest

from cleave.settings import Settings
from helpers.api import problem, submit, traces
from helpers.jobs import sphere
from helpers.servers import serving
from worker.jobs.store.store import JobStore
from worker.process.perform import perform

UNKNOWN = "/v1/batches/" + "0" * 32
MESHES = {f"mesh{rows}.off": sphere(rows) for rows in (10, 11, 12)}


def archive(members: dict[str, bytes], compression: int = zipfile.ZIP_DEFLATED) -> bytes:
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", compression) as file:
        for name, data in members.items():
            file.writestr(name, data)
    return target.getvalue()


def post_zip(client: httpx.Client, data: bytes) -> httpx.Response:
    return client.post("/v1/batches", content=data, headers={"Content-Type": "application/zip"})


def work(store: JobStore, settings: Settings) -> None:
    for job_id in store.pending.all():
        perform(store, settings, job_id, lambda *_: None)


def test_many_meshes_in_a_form_are_a_batch_with_one_archive(
    client: httpx.Client, store: JobStore, settings: Settings
) -> None:
    files = [("mesh", (name, data)) for name, data in MESHES.items()] + [("mesh", ("bad.off", b"OFF\n1"))]
    accepted = client.post("/v1/batches", files=files, data={"parameters": '{"max_segments": 7}'})
    assert accepted.status_code == 202
    path = accepted.headers["Location"]
    assert accepted.json() == client.get(path).json()
    assert accepted.json()["counts"] == {"queued": 4}
    problem(client.get(f"{path}/results.zip"), 409, "not_finished")
    work(store, settings)
    batch = client.get(path, params={"wait": 30}).json()
    assert (batch["status"], batch["counts"]) == ("finished", {"succeeded": 3, "failed": 1})
    assert [job["file_name"] for job in batch["jobs"]] == [*MESHES, "bad.off"]
    assert batch["jobs"][3]["error"]["code"] == "invalid_mesh"
    answer = client.get(batch["links"]["results"], params={"segments": 3})
    results = zipfile.ZipFile(io.BytesIO(answer.content))
    assert results.testzip() is None
    for number, job in enumerate(batch["jobs"][:3], start=1):
        folder = f"{number:04d}-mesh{9 + number}"
        labels = client.get(f"{job['self']}/labels", params={"segments": 3, "format": "seg"}).content
        assert results.read(f"{folder}/labels.seg") == labels
        assert json.loads(results.read(f"{folder}/hierarchy.json")) == client.get(f"{job['self']}/hierarchy").json()
        assert results.read(f"{folder}/model.glb").startswith(b"glTF")
    assert json.loads(results.read("0004-bad/job.json"))["status"] == "failed"


def test_an_archive_of_meshes_is_a_batch(client: httpx.Client, store: JobStore) -> None:
    members = {f"folder/{name}": data for name, data in MESHES.items()}
    answer = post_zip(client, archive(members | {"__MACOSX/._mesh": b"x", "folder/.DS_Store": b"x", "folder/": b""}))
    assert answer.status_code == 202, answer.text
    jobs = answer.json()["jobs"]
    assert [job["file_name"] for job in jobs] == list(MESHES)
    for job, data in zip(jobs, MESHES.values(), strict=True):
        with store.open_mesh(job["id"]) as mesh:
            assert mesh.read() == data


def test_jobs_that_there_are_can_be_put_together(client: httpx.Client) -> None:
    ids = [submit(client).rpartition("/")[2] for _ in range(2)]
    answer = client.post("/v1/batches", json={"jobs": ids})
    assert [job["id"] for job in answer.json()["jobs"]] == ids
    client.delete(f"/v1/jobs/{ids[0]}")
    assert client.get(answer.headers["Location"]).json()["counts"] == {"deleted": 1, "queued": 1}
    problem(client.post("/v1/batches", json={"jobs": ["0" * 32]}), 404, "job_not_found")
    for wrong in ({"jobs": []}, {"jobs": [1]}, [], {}):
        problem(client.post("/v1/batches", json=wrong), 400, "malformed_request")


def test_a_batch_can_be_forgotten_without_its_jobs(client: httpx.Client) -> None:
    job = submit(client)
    path = client.post("/v1/batches", json={"jobs": [job.rpartition("/")[2]]}).headers["Location"]
    assert client.delete(path).status_code == 204
    problem(client.get(path), 404, "batch_not_found")
    problem(client.get(f"{UNKNOWN}/results.zip"), 404, "batch_not_found")
    assert client.get(job).status_code == 200


def lying_directory(data: bytes) -> bytes:
    """An archive that says that its list of contents is a gigabyte long."""
    at = data.rfind(b"PK\5\6")
    return data[: at + 12] + struct.pack("<I", 2**30) + data[at + 16 :]


MANY = archive({f"{number}.off": b"x" for number in range(6)})


@pytest.mark.parametrize(
    ("data", "status", "code"),
    [
        (b"", 400, "malformed_request"),
        (b"PK\3\4 no archive", 400, "malformed_request"),
        (archive({}), 400, "malformed_request"),
        (archive(MESHES)[:-30], 400, "malformed_request"),
        (archive({"a.off": b"abc", "b.off": b""}), 422, "invalid_mesh"),
        (archive({"bomb.off": bytes(50_000_000)}), 413, "too_large"),
        (archive({f"{number}.off": bytes(150_000) for number in range(4)}), 413, "too_large"),
        (MANY, 413, "too_large"),
        (lying_directory(archive(MESHES)), 413, "too_large"),
        (archive(MESHES).replace(b"PK\1\2", b"PK\1\3"), 400, "malformed_request"),
    ],
)
def test_an_archive_that_cannot_be_used_is_refused_and_leaves_nothing(
    settings: Settings, data: bytes, status: int, code: str
) -> None:
    with serving(settings.model_copy(update={"max_batch_jobs": 5, "max_batch_bytes": 500_000})) as client:
        problem(post_zip(client, data), status, code)
    assert traces(settings.data_dir) == []


def test_a_name_in_an_archive_is_never_a_path(client: httpx.Client, tmp_path: Path, settings: Settings) -> None:
    names = ["../../escape.off", "/escape.off", "C:\\escape.off", "..\\escape.off"]
    answer = post_zip(client, archive({f"{name}{number}": b"abc" for number, name in enumerate(names)}))
    assert answer.status_code == 202
    assert list(tmp_path.rglob("*escape*")) == []
    assert {file.name[:5] for file in (settings.data_dir / "jobs").rglob("*") if file.is_file()} == {"mesh-", "job.j"}


def test_a_batch_needs_room_for_all_of_its_jobs(settings: Settings) -> None:
    with serving(settings.model_copy(update={"key_max_queued_jobs": 2})) as client:
        problem(post_zip(client, archive(MESHES)), 429, "too_many_jobs")
    assert traces(settings.data_dir) == []


def test_a_batch_of_another_kind_is_refused(client: httpx.Client) -> None:
    problem(
        client.post("/v1/batches", content=b"abc", headers={"Content-Type": "model/off"}), 415, "unsupported_media_type"
    )
