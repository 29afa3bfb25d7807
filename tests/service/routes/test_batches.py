"""Batches: many meshes, all or none, with one status and one archive."""

import io
import json
import zipfile

import httpx

from cleave.settings import Settings
from helpers.api import problem, submit, traces
from helpers.jobs import sphere, unfinished
from helpers.servers import serving
from helpers.uploads import post_zip, zip_of
from worker.jobs.store.store import JobStore
from worker.process.perform import perform

UNKNOWN = "/v1/batches/" + "0" * 32


MESHES = {f"mesh{rows}.off": sphere(rows) for rows in (10, 11, 12)}


def work(store: JobStore, settings: Settings) -> None:
    for job_id in unfinished(store):
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


def test_existing_jobs_can_be_combined(client: httpx.Client) -> None:
    ids = [submit(client).rpartition("/")[2] for _ in range(2)]
    answer = client.post("/v1/batches", json={"jobs": ids})
    assert [job["id"] for job in answer.json()["jobs"]] == ids
    client.delete(f"/v1/jobs/{ids[0]}")
    assert client.get(answer.headers["Location"]).json()["counts"] == {"deleted": 1, "queued": 1}
    problem(client.post("/v1/batches", json={"jobs": ["0" * 32]}), 404, "job_not_found")
    for wrong in ({"jobs": []}, {"jobs": [1]}, [], {}):
        problem(client.post("/v1/batches", json=wrong), 400, "malformed_request")


def test_a_batch_can_be_deleted_without_its_jobs(client: httpx.Client) -> None:
    job = submit(client)
    path = client.post("/v1/batches", json={"jobs": [job.rpartition("/")[2]]}).headers["Location"]
    assert client.delete(path).status_code == 204
    problem(client.get(path), 404, "batch_not_found")
    problem(client.get(f"{UNKNOWN}/results.zip"), 404, "batch_not_found")
    assert client.get(job).status_code == 200


def test_all_jobs_of_a_batch_count_against_the_limits(settings: Settings) -> None:
    with serving(settings.model_copy(update={"key_max_queued_jobs": 2})) as client:
        problem(post_zip(client, zip_of(MESHES)), 429, "too_many_jobs")
    assert traces(settings.data_dir) == []


def test_a_batch_in_another_format_is_refused(client: httpx.Client) -> None:
    problem(
        client.post("/v1/batches", content=b"abc", headers={"Content-Type": "model/off"}), 415, "unsupported_media_type"
    )
