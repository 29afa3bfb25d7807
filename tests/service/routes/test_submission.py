"""Submission of one mesh, with the job or its labels in the response."""

import threading

import httpx
import pytest

from cleave.settings import Settings
from helpers.api import problem, traces
from helpers.jobs import SMALL, sphere
from helpers.servers import working
from helpers.waiting import wait_until
from worker.jobs.queue.queue import JobQueue
from worker.jobs.store.store import JobStore

MESH = sphere(12)


def test_a_submitted_mesh_is_a_queued_job_at_its_location(
    client: httpx.Client, store: JobStore, queue: JobQueue
) -> None:
    answer = client.post("/v1/jobs", files={"mesh": ("hand.off", b"some bytes")}, data={"parameters": '{"seed": 5}'})
    assert answer.status_code == 202
    job = answer.json()
    assert answer.headers["Location"] == job["links"]["self"] == f"/v1/jobs/{job['id']}"
    assert (job["status"], job["progress"], job["error"]) == ("queued", 0.0, None)
    assert job["parameters"]["seed"] == 5
    assert job["parameters"]["max_segments"] is None
    assert client.get(answer.headers["Location"]).json() == job
    with store.open_mesh(job["id"]) as mesh:
        assert mesh.read() == b"some bytes"
    assert queue.entries[SMALL].get_job_ids() == [job["id"]]


def test_a_waiting_client_gets_the_labels_in_one_round_trip(
    client: httpx.Client, store: JobStore, settings: Settings
) -> None:
    with working(store, settings):
        answer = client.post("/v1/jobs?segments=3", content=MESH, headers={"Prefer": "wait=60"})
    assert answer.status_code == 200
    assert answer.headers["Preference-Applied"] == "wait=60"
    job = answer.json()
    labels = client.get(job["links"]["labels"], params={"segments": 3}).json()
    assert (job["segments"], job["labels"]) == (3, labels["labels"])
    assert {**client.get(job["links"]["self"]).json(), **labels} == job


def test_a_waiting_client_gets_the_labels_at_a_granularity(
    client: httpx.Client, store: JobStore, settings: Settings
) -> None:
    with working(store, settings):
        answer = client.post("/v1/jobs?granularity=1", content=MESH, headers={"Prefer": "wait=60"})
    job = answer.json()
    assert job["segments"] == job["max_segments"] == len(set(job["labels"]))


def test_a_client_that_waits_too_briefly_gets_the_job(client: httpx.Client) -> None:
    answer = client.post("/v1/jobs", content=MESH, headers={"Prefer": "wait=1"})
    assert answer.status_code == 202
    assert answer.json()["status"] == "queued"
    assert int(answer.headers["Retry-After"]) > 0


def test_a_waiting_request_ends_when_the_job_is_canceled(client: httpx.Client) -> None:
    answers: list[httpx.Response] = []
    thread = threading.Thread(
        target=lambda: answers.append(client.post("/v1/jobs", content=MESH, headers={"Prefer": "wait=60"}))
    )
    thread.start()
    wait_until(lambda: client.get("/v1/jobs").json()["jobs"])
    (job,) = client.get("/v1/jobs").json()["jobs"]
    client.post(job["links"]["cancel"])
    thread.join(30)
    assert answers[0].status_code == 200
    assert (answers[0].json()["status"], answers[0].json()["labels"]) == ("canceled", None)


def test_more_segments_than_max_segments_are_refused_before_the_job_runs(client: httpx.Client) -> None:
    problem(client.post("/v1/jobs?segments=65", content=MESH), 422, "invalid_parameters")
    assert client.get("/v1/jobs").json()["jobs"] == []


def test_an_upload_to_a_full_disk_is_refused_and_leaves_no_files(
    client: httpx.Client, monkeypatch: pytest.MonkeyPatch, settings: Settings
) -> None:
    def fail(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("worker.jobs.store.upload.MeshUpload.write", fail)
    answer = client.post("/v1/jobs", files={"mesh": ("mesh.off", sphere(12))})
    problem(answer, 507, "insufficient_storage")
    assert traces(settings.data_dir) == []
