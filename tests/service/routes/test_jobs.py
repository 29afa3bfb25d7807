"""The job API: what is submitted can be polled, fetched at every number of segments, canceled and deleted."""

import threading
from collections.abc import Callable

import httpx
import pytest

from cleave.settings import Settings
from helpers.api import FACES, UNKNOWN, problem, submit, traces
from helpers.jobs import SMALL, sphere
from segcore.io.result import read_result
from worker.jobs.queue.queue import JobQueue, Progress
from worker.jobs.store.records import Records
from worker.jobs.store.store import JobStore


def test_a_submitted_mesh_is_a_queued_job_at_its_location(
    client: httpx.Client, store: JobStore, queue: JobQueue
) -> None:
    answer = client.post("/v1/jobs", files={"mesh": ("hand.off", b"some bytes")}, data={"parameters": '{"seed": 5}'})
    assert answer.status_code == 202
    job = answer.json()
    assert answer.headers["Location"] == job["links"]["self"] == f"/v1/jobs/{job['id']}"
    assert (job["status"], job["progress"], job["error"]) == ("queued", 0.0, None)
    assert job["parameters"]["seed"] == 5
    assert job["parameters"]["max_segments"] == 64
    assert client.get(answer.headers["Location"]).json() == job
    with store.open_mesh(job["id"]) as mesh:
        assert mesh.read() == b"some bytes"
    assert queue.entries[SMALL].get_job_ids() == [job["id"]]


def test_a_job_that_a_worker_holds_is_running_with_its_stage(client: httpx.Client, queue: JobQueue) -> None:
    path = submit(client)
    job_id = path.rpartition("/")[2]
    queue.take(job_id, "worker", lease_s=30)
    assert client.get(path).json()["status"] == "running"
    queue.publish(job_id, Progress("coarsen", 0.5))
    job = client.get(path).json()
    assert (job["status"], job["stage"], job["progress"]) == ("running", "coarsen", 0.5)


def test_a_finished_job_says_what_can_be_asked_for(client: httpx.Client, finished_job: Callable[..., str]) -> None:
    job = client.get(finished_job()).json()
    assert (job["status"], job["progress"], job["stage"]) == ("succeeded", 1.0, None)
    report = job["mesh"].pop("report")
    assert job["mesh"] == {"faces": FACES, "vertices": FACES // 2 + 2}
    assert (report["components"], report["is_closed"], report["border_edges"]) == (1, True, 0)
    assert 1 <= job["automatic_segments"] <= job["max_segments"]
    assert job["created_at"] <= job["finished_at"]


def test_labels_are_those_of_the_stored_hierarchy_at_every_number_of_segments(
    client: httpx.Client, store: JobStore, finished_job: Callable[..., str]
) -> None:
    path = finished_job()
    with store.results.open(path.rpartition("/")[2]) as file:
        hierarchy = read_result(file).hierarchy
    for segments in (1, 2, hierarchy.max_segments):
        document = client.get(f"{path}/labels", params={"segments": segments}).json()
        assert document == {"segments": segments, "labels": hierarchy.labels(segments).tolist()}
    automatic = client.get(f"{path}/labels").json()
    assert automatic == {"segments": hierarchy.automatic_segments, "labels": hierarchy.labels().tolist()}
    assert len(automatic["labels"]) == FACES


def test_the_hierarchy_is_the_whole_tree(client: httpx.Client, finished_job: Callable[..., str]) -> None:
    path = finished_job()
    document = client.get(f"{path}/hierarchy").json()
    assert len(document["nodes"]) == 2 * document["max_segments"] - 1
    assert document["nodes"][0]["faces"] == FACES
    assert document["max_segments"] == client.get(path).json()["max_segments"]


def test_the_model_is_a_glb_of_the_segments(client: httpx.Client, finished_job: Callable[..., str]) -> None:
    answer = client.get(f"{finished_job()}/model.glb", params={"segments": 3})
    assert answer.headers["Content-Type"] == "model/gltf-binary"
    assert answer.content[:4] == b"glTF"
    assert b"segment 2" in answer.content
    assert b"segment 3" not in answer.content


@pytest.mark.parametrize("result", ["labels", "hierarchy", "model.glb"])
def test_results_of_a_job_that_has_none_are_a_conflict(
    client: httpx.Client, finished_job: Callable[..., str], result: str
) -> None:
    answer = client.get(f"{submit(client)}/{result}")
    problem(answer, 409, "not_finished")
    assert int(answer.headers["Retry-After"]) > 0
    failed = problem(client.get(f"{finished_job(b'PK' + bytes([3, 4]))}/{result}"), 409, "job_failed")
    assert failed["error"]["code"] == "unsupported_format"  # type: ignore[index]
    canceled = submit(client)
    client.post(f"{canceled}/cancel")
    problem(client.get(f"{canceled}/{result}"), 409, "job_canceled")
    problem(client.get(f"{UNKNOWN}/{result}"), 404, "job_not_found")


def test_a_bad_mesh_ends_as_a_failed_job_with_a_reason(client: httpx.Client, finished_job: Callable[..., str]) -> None:
    job = client.get(finished_job(b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 9\n")).json()
    assert job["status"] == "failed"
    assert job["error"]["code"] == "invalid_mesh"
    assert job["error"]["message"].endswith(".")


@pytest.mark.parametrize("segments", ["0", "-1", "100000", "x", "1.5", "", "9" * 5000, "NaN", "%ED%A0%80"])
def test_a_number_of_segments_that_is_none_is_refused_with_a_sentence(
    client: httpx.Client, finished_job: Callable[..., str], segments: str
) -> None:
    answer = client.get(f"{finished_job()}/labels?segments={segments}")
    body = problem(answer, 422, "invalid_parameters" if segments == "100000" else "invalid_request")
    if segments == "100000":
        assert "from 1 to" in str(body["detail"])


def test_a_queued_job_is_canceled_at_once_and_for_good(client: httpx.Client, queue: JobQueue) -> None:
    path = submit(client)
    canceled = client.post(f"{path}/cancel")
    assert canceled.status_code == 200
    assert canceled.json()["status"] == "canceled"
    assert queue.entries[SMALL].get_job_ids() == []
    assert client.post(f"{path}/cancel").json() == client.get(path).json()


def test_a_finished_job_cannot_be_canceled(client: httpx.Client, finished_job: Callable[..., str]) -> None:
    path = finished_job()
    problem(client.post(f"{path}/cancel"), 409, "already_finished")
    assert client.get(path).json()["status"] == "succeeded"


def test_of_many_cancels_at_once_all_agree(client: httpx.Client) -> None:
    path = submit(client)
    answers: list[dict[str, object]] = []
    threads = [threading.Thread(target=lambda: answers.append(client.post(f"{path}/cancel").json())) for _ in range(12)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(answers) == 12
    assert all(answer == answers[0] for answer in answers)
    assert answers[0]["status"] == "canceled"


def test_a_deleted_job_is_gone_with_its_files(
    client: httpx.Client, finished_job: Callable[..., str], settings: Settings, queue: JobQueue
) -> None:
    for path in (finished_job(), submit(client)):
        client.get(f"{path}/labels")
        assert client.delete(path).status_code == 204
        for gone in (client.get(path), client.get(f"{path}/labels"), client.delete(path)):
            problem(gone, 410, "job_deleted")
    assert traces(settings.data_dir) == []
    assert queue.entries[SMALL].get_job_ids() == []


@pytest.mark.parametrize("name", ["0" * 32, "x", "..%2f..%2fetc%2fpasswd", "%00", "0" * 31 + "%0a", "%F0%9F%92%A9"])
def test_an_unknown_job_is_not_found(client: httpx.Client, name: str) -> None:
    for answer in (
        client.get(f"/v1/jobs/{name}"),
        client.delete(f"/v1/jobs/{name}"),
        client.post(f"/v1/jobs/{name}/cancel"),
        client.get(f"/v1/jobs/{name}/labels"),
    ):
        assert answer.status_code == 404
        assert answer.json()["code"] in ("job_not_found", "not_found")


def test_a_service_is_ready_when_queue_store_and_worker_are(client: httpx.Client, queue: JobQueue) -> None:
    assert client.get("/healthz").json() == {"status": "ok"}
    waiting = client.get("/readyz")
    assert waiting.status_code == 503
    assert waiting.json() == {
        "ready": False,
        "queue": True,
        "store": True,
        "workers": 0,
        "missing": ["No worker for small jobs is ready.", "No worker for large jobs is ready."],
    }
    for size in ("small", "large"):
        queue.connection.sadd(f"rq:workers:cleave:{size}", f"rq:worker:{size}")
        queue.connection.hset(f"rq:worker:{size}", "state", "idle")
    ready = client.get("/readyz")
    assert (ready.status_code, ready.json()["workers"]) == (200, 2)


def test_without_its_queue_the_service_takes_no_jobs_and_serves_results(
    client_without_queue: httpx.Client, finished_job: Callable[..., str], client: httpx.Client, settings: Settings
) -> None:
    finished, waiting = finished_job(), submit(client)
    before = sorted(settings.data_dir.rglob("*"))
    refused = client_without_queue.post("/v1/jobs", files={"mesh": ("mesh.off", sphere(12))})
    problem(refused, 503, "queue_unavailable")
    assert int(refused.headers["Retry-After"]) > 0
    assert sorted(settings.data_dir.rglob("*")) == before
    assert client_without_queue.get(finished).json()["status"] == "succeeded"
    assert client_without_queue.get(f"{finished}/labels?segments=2").status_code == 200
    assert client_without_queue.get(waiting).json()["status"] == "queued"
    assert client_without_queue.post(f"{waiting}/cancel").json()["status"] == "canceled"
    assert client_without_queue.get("/readyz").json()["missing"][0] == "The queue server does not answer."
    assert client_without_queue.get("/healthz").status_code == 200


def test_what_is_accepted_while_the_queue_goes_down_stays_accepted(
    client: httpx.Client, monkeypatch: pytest.MonkeyPatch, store: JobStore, queue: JobQueue
) -> None:
    from redis.exceptions import ConnectionError as QueueConnectionError

    def fail(*_: object, **__: object) -> None:
        raise QueueConnectionError

    monkeypatch.setattr(JobQueue, "enqueue", fail)
    path = submit(client)
    assert list(store.pending.all()) == [path.rpartition("/")[2]]
    assert queue.entries[SMALL].get_job_ids() == []


def test_a_full_disk_is_said_and_leaves_nothing(
    client: httpx.Client, monkeypatch: pytest.MonkeyPatch, settings: Settings
) -> None:
    def fail(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("worker.jobs.store.upload.MeshUpload.write", fail)
    answer = client.post("/v1/jobs", files={"mesh": ("mesh.off", sphere(12))})
    problem(answer, 507, "insufficient_storage")
    assert traces(settings.data_dir) == []


def test_an_internal_error_tells_no_secrets(client: httpx.Client, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        raise ZeroDivisionError("secret")

    monkeypatch.setattr(Records, "job", fail)
    answer = client.get(UNKNOWN)
    problem(answer, 500, "internal_error")
    assert "secret" not in answer.text


def test_other_paths_and_methods_are_problems_too(client: httpx.Client) -> None:
    problem(client.get("/v2"), 404, "not_found")
    problem(client.get("/v1/jobs/"), 404, "not_found")
    wrong = client.put("/v1/jobs")
    problem(wrong, 405, "method_not_allowed")
    assert "POST" in wrong.headers["Allow"]


def test_every_documented_error_is_a_problem(client: httpx.Client) -> None:
    document = client.get("/openapi.json").json()
    for path, operations in document["paths"].items():
        for operation in operations.values():
            for status, response in operation["responses"].items():
                if status >= "400" and path != "/readyz":
                    assert list(response["content"]) == ["application/problem+json"], (path, status)
