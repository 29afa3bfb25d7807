"""Results are shared, repeated requests create no second job, and accepted jobs stay accepted."""

import threading
from collections.abc import Callable

import httpx
import pytest

from helpers.api import AGAIN, problem, submit
from helpers.jobs import SMALL, sphere, unfinished
from worker.jobs.queue.queue import JobQueue
from worker.jobs.store.store import JobStore

MESH = sphere(12)


def test_a_computed_result_is_shared_by_a_job_of_its_own(
    client: httpx.Client, finished_job: Callable[..., str], queue: JobQueue
) -> None:
    path = finished_job(MESH)
    before = queue.entries[SMALL].get_job_ids()
    form = {"files": {"mesh": ("other.off", MESH)}}
    again = client.post("/v1/jobs", **form)  # type: ignore[arg-type]
    assert again.status_code == 200
    own = again.headers["Location"]
    assert own != path
    assert again.json()["labels"] is None
    assert again.json()["input"]["file_name"] == "other.off"
    assert again.json()["created_at"] > client.get(path).json()["finished_at"]
    assert client.get(f"{own}/labels").content == client.get(f"{path}/labels").content
    waited = client.post("/v1/jobs", **form, headers={"Prefer": "wait=1"})  # type: ignore[arg-type]
    assert len(waited.json()["labels"]) == waited.json()["mesh"]["faces"]
    assert queue.entries[SMALL].get_job_ids() == before
    assert len(client.get("/v1/jobs").json()["jobs"]) == 3
    for other in (
        client.post("/v1/jobs", **form, headers=AGAIN),  # type: ignore[arg-type]
        client.post("/v1/jobs", **form, data={"parameters": '{"seed": 3}'}),  # type: ignore[arg-type]
        client.post("/v1/jobs", content=sphere(11)),
    ):
        assert other.status_code == 202


def test_the_deletion_of_a_job_leaves_the_others_with_the_same_mesh(
    client: httpx.Client, finished_job: Callable[..., str]
) -> None:
    first = finished_job(MESH)
    second, third = (client.post("/v1/jobs", files={"mesh": ("other.off", MESH)}).headers["Location"] for _ in range(2))
    for gone, left in ((first, second), (second, third)):
        assert client.delete(gone).status_code == 204
        assert client.get(gone).status_code == 410
        assert client.get(f"{left}/labels").status_code == 200
        assert client.get(f"{left}/model.glb").status_code == 200
    client.delete(third)
    assert client.post("/v1/jobs", files={"mesh": ("other.off", MESH)}).status_code == 202


def test_a_job_that_shares_a_result_has_its_own_webhook(
    client: httpx.Client, finished_job: Callable[..., str], store: JobStore
) -> None:
    finished_job(MESH)
    query = {"webhook": "https://example.com/hook"}
    answer = client.post("/v1/jobs", files={"mesh": ("mesh.off", MESH)}, params=query)
    assert answer.status_code == 200
    assert store.outbox.job_ids() == {answer.json()["id"]}


def test_failed_and_deleted_jobs_are_not_reused(client: httpx.Client, finished_job: Callable[..., str]) -> None:
    finished_job(b"PK\3\4")
    assert client.post("/v1/jobs", files={"mesh": ("mesh.off", b"PK\3\4")}).status_code == 202
    client.delete(finished_job(MESH))
    assert client.post("/v1/jobs", files={"mesh": ("mesh.off", MESH)}).status_code == 202


def test_a_repeated_request_creates_no_second_job(client: httpx.Client, queue: JobQueue) -> None:
    headers = {"Idempotency-Key": "order 66"}
    first = client.post("/v1/jobs", content=MESH, headers=headers)
    again = client.post("/v1/jobs", content=MESH, headers=headers)
    assert first.json() == again.json()
    assert len(queue.entries[SMALL].get_job_ids()) == 1
    assert len(client.get("/v1/jobs").json()["jobs"]) == 1
    problem(client.post("/v1/jobs", content=sphere(11), headers=headers), 422, "idempotency_key_reused")
    other = client.post('/v1/jobs?parameters={"seed":1}', content=MESH, headers=headers)
    problem(other, 422, "idempotency_key_reused")
    client.delete(first.headers["Location"])
    problem(client.post("/v1/jobs", content=MESH, headers=headers), 409, "idempotency_key_spent")


def test_concurrent_requests_with_one_key_create_one_job(client: httpx.Client, queue: JobQueue) -> None:
    answers: list[httpx.Response] = []

    def send() -> None:
        answers.append(client.post("/v1/jobs", content=MESH, headers={"Idempotency-Key": "k"}))

    threads = [threading.Thread(target=send) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert {answer.status_code for answer in answers} == {202}
    assert len({answer.headers["Location"] for answer in answers}) == 1
    assert len(queue.entries[SMALL].get_job_ids()) == 1


def test_a_key_of_a_job_that_shares_a_result_can_be_repeated(
    client: httpx.Client, finished_job: Callable[..., str]
) -> None:
    path = finished_job(MESH)
    form = {"mesh": ("mesh.off", MESH)}
    answers = [client.post("/v1/jobs", files=form, headers={"Idempotency-Key": "k"}) for _ in range(2)]
    assert [answer.status_code for answer in answers] == [200, 200]
    assert answers[0].headers["Location"] == answers[1].headers["Location"] != path


def test_a_job_stays_accepted_if_the_queue_fails_during_its_submission(
    client: httpx.Client, monkeypatch: pytest.MonkeyPatch, store: JobStore, queue: JobQueue
) -> None:
    from redis.exceptions import ConnectionError as QueueConnectionError

    def fail(*_: object, **__: object) -> None:
        raise QueueConnectionError

    monkeypatch.setattr(JobQueue, "enqueue", fail)
    path = submit(client)
    assert list(unfinished(store)) == [path.rpartition("/")[2]]
    assert queue.entries[SMALL].get_job_ids() == []


def test_a_result_is_reused_only_with_the_same_unit_and_axis(
    client: httpx.Client, finished_job: Callable[..., str]
) -> None:
    path = finished_job(unit="mm", up="z")
    files = {"mesh": ("mesh.off", sphere(12))}
    again = client.post("/v1/jobs", files=files, params={"unit": "millimetres", "up": "z"})
    other = client.post("/v1/jobs", files=files, params={"unit": "inch", "up": "z"})
    assert again.status_code == 200
    assert other.status_code == 202
    assert client.get(again.headers["Location"]).json()["mesh"] == client.get(path).json()["mesh"]


def test_a_unit_that_does_not_exist_is_refused_with_the_nearest_one(client: httpx.Client) -> None:
    answer = client.post("/v1/jobs", files={"mesh": ("mesh.off", sphere(12))}, params={"unit": "milimeter"})
    assert "as in 'millimeter'" in str(problem(answer, 422, "invalid_parameters")["detail"])
