"""The list of jobs and the document of one: what they say, in which order, and whether it has changed."""

import time
from collections.abc import Callable

import httpx

from helpers.api import problem, submit
from helpers.jobs import SMALL, sphere
from service.documents import Status
from worker.jobs.queue.queue import JobQueue


def test_jobs_are_listed_newest_first_page_by_page(client: httpx.Client) -> None:
    paths = [submit(client) for _ in range(5)]
    found, cursor = [], None
    while True:
        page = client.get("/v1/jobs", params={"limit": 2} | ({"cursor": cursor} if cursor else {})).json()
        found += [job["links"]["self"] for job in page["jobs"]]
        cursor = page["next_cursor"]
        if cursor is None:
            break
    assert found == paths[::-1]


def test_a_job_in_the_list_is_as_it_is_by_itself(client: httpx.Client, finished_job: Callable[..., str]) -> None:
    for make in (finished_job, lambda: submit(client)):
        path = make()
        assert client.get("/v1/jobs", params={"limit": 1}).json()["jobs"] == [client.get(path).json()]


def test_the_list_is_of_the_jobs_of_a_status(client: httpx.Client, finished_job: Callable[..., str]) -> None:
    paths: dict[Status, str] = {"succeeded": finished_job(), "queued": submit(client), "canceled": submit(client)}
    client.post(f"{paths['canceled']}/cancel")
    for status, path in paths.items():
        (job,) = client.get("/v1/jobs", params={"status": status}).json()["jobs"]
        assert job["links"]["self"] == path


def test_a_cursor_that_is_none_is_refused(client: httpx.Client) -> None:
    for cursor in ("x", "..", "../../etc", "0" * 32):
        problem(client.get("/v1/jobs", params={"cursor": cursor}), 422, "invalid_request")


def test_a_deleted_job_is_not_listed(client: httpx.Client) -> None:
    path, kept = submit(client), submit(client)
    client.delete(path)
    assert [job["links"]["self"] for job in client.get("/v1/jobs").json()["jobs"]] == [kept]


def test_waiting_jobs_know_their_place(client: httpx.Client, queue: JobQueue) -> None:
    paths = [submit(client) for _ in range(3)]
    assert [client.get(path).json()["queue_position"] for path in paths] == [1, 2, 3]
    first = queue.entries[SMALL].pop_job_id()
    queue.take(first, "worker", lease_s=30)
    assert [client.get(path).json()["queue_position"] for path in paths] == [None, 1, 2]


def test_the_document_has_the_name_of_the_file_and_its_digest(client: httpx.Client) -> None:
    answer = client.post("/v1/jobs", files={"mesh": ("../my hand.off", b"abc")})
    assert answer.json()["input"] == {
        "file_name": "my hand.off",
        "format": "off",
        "size_bytes": 3,
        "sha256": "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad",
    }


def test_a_document_that_has_not_changed_is_not_sent_again(client: httpx.Client, queue: JobQueue) -> None:
    path = submit(client)
    for url in (path, "/v1/jobs"):
        first = client.get(url)
        again = client.get(url, headers={"If-None-Match": first.headers["ETag"]})
        assert (again.status_code, again.content) == (304, b"")
    queue.take(path.rpartition("/")[2], "worker", lease_s=30)
    assert client.get(path, headers={"If-None-Match": first.headers["ETag"]}).status_code == 200


def test_a_long_poll_answers_at_the_end_of_the_job_or_of_the_time(client: httpx.Client) -> None:
    path = submit(client)
    began_at = time.monotonic()
    assert client.get(path, params={"wait": 0.3}).json()["status"] == "queued"
    assert time.monotonic() - began_at >= 0.3
    client.post(f"{path}/cancel")
    assert client.get(path, params={"wait": 60}).json()["status"] == "canceled"
    problem(client.get(path, params={"wait": 601}), 422, "invalid_request")


def test_formats_and_methods_say_what_is_taken(client: httpx.Client) -> None:
    formats = client.get("/v1/formats").json()
    assert {"off", "stl", "ply", "obj", "glb"} <= {form["name"] for form in formats["meshes"]}
    assert formats["max_upload_bytes"] == 200_000
    schema = client.get("/v1/methods").json()
    answer = client.post("/v1/jobs", files={"mesh": ("mesh.off", sphere(12))})
    for name, value in answer.json()["parameters"].items():
        assert schema["properties"][name]["default"] == value
