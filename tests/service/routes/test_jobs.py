"""Jobs: documents, list, long polling, cancellation and deletion."""

import json
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from datetime import timedelta

import httpx
import pytest

from cleave.settings import Settings
from helpers.api import AGAIN, FACES, problem, submit, traces
from helpers.files.samples import TWO_SQUARES
from helpers.jobs import SMALL
from service.job_documents import Status
from worker.jobs.job import now
from worker.jobs.queue.queue import JobQueue, Progress
from worker.jobs.store.layout import job_key
from worker.jobs.store.records import ATTEMPT
from worker.jobs.store.store import JobStore
from worker.process.perform import perform


def test_a_leased_job_is_running_and_has_a_stage(client: httpx.Client, queue: JobQueue) -> None:
    path = submit(client)
    job_id = path.rpartition("/")[2]
    queue.take(job_id, "worker", lease_s=30)
    assert client.get(path).json()["status"] == "running"
    queue.publish(job_id, Progress("coarsen", 0.5))
    job = client.get(path).json()
    assert (job["status"], job["stage"], job["progress"]) == ("running", "coarsen", 0.5)
    assert job["seconds_left"] is None  # no attempt has begun


def test_a_running_job_says_how_long_it_still_takes(client: httpx.Client, store: JobStore, queue: JobQueue) -> None:
    path = submit(client)
    job_id = path.rpartition("/")[2]
    attempt = replace(store.begin_attempt(job_id, "worker"), started_at=now() - timedelta(seconds=90))
    store.records.withdraw_attempt(job_id, attempt)
    store.objects.create(job_key(job_id, "attempt-1.json"), ATTEMPT.dump_json(attempt))
    queue.take(job_id, "worker", lease_s=30)
    queue.publish(job_id, Progress("cut", 0.75))
    assert 30 <= client.get(path).json()["seconds_left"] < 90


def test_a_finished_job_describes_its_mesh_and_levels(client: httpx.Client, finished_job: Callable[..., str]) -> None:
    job = client.get(finished_job()).json()
    assert (job["status"], job["progress"], job["stage"]) == ("succeeded", 1.0, None)
    report = job["mesh"].pop("report")
    assert job["mesh"] == {"faces": FACES, "vertices": FACES // 2 + 2}
    assert (report["components"], report["is_closed"], report["border_edges"]) == (1, True, 0)
    assert 1 <= job["automatic_segments"] <= job["max_segments"]
    assert job["created_at"] <= job["finished_at"]


def test_a_job_counts_the_structure_of_its_file_and_notes_what_limits_the_result(
    client: httpx.Client, settings: Settings, store: JobStore
) -> None:
    notes = {"none": 0, "groups": 1, "materials": 1, "shells": 1}
    for structure, count in notes.items():
        parameters = json.dumps({"structure": structure, "max_segments": 2})
        files = {"mesh": ("two.obj", TWO_SQUARES.encode())}
        job = client.post("/v1/jobs", files=files, data={"parameters": parameters}, headers=AGAIN).json()
        assert job["notes"] == []
        perform(store, settings, job["id"], lambda *_: None)
        job = client.get(job["links"]["self"]).json()
        assert job["mesh"]["report"]["structure"] == {"shells": 2, "groups": 2, "materials": 1}
        assert len(job["notes"]) == count
        assert all(f" {structure} of the file" in note for note in job["notes"])


def test_a_job_whose_file_lacks_the_structure_fails_with_a_remedy(
    client: httpx.Client, settings: Settings, store: JobStore
) -> None:
    path = submit(client, parameters='{"structure": "materials"}')
    perform(store, settings, path.rpartition("/")[2], lambda *_: None)
    job = client.get(path).json()
    assert (job["status"], job["error"]["code"]) == ("failed", "invalid_parameters")
    assert "use structure=shells" in job["error"]["message"]


def test_a_bad_mesh_ends_as_a_failed_job_with_a_reason(client: httpx.Client, finished_job: Callable[..., str]) -> None:
    job = client.get(finished_job(b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 9\n")).json()
    assert job["status"] == "failed"
    assert job["error"]["code"] == "invalid_mesh"
    assert job["error"]["message"].endswith(".")


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


def test_a_listed_job_equals_its_own_document(client: httpx.Client, finished_job: Callable[..., str]) -> None:
    for make in (finished_job, lambda: submit(client)):
        path = make()
        assert client.get("/v1/jobs", params={"limit": 1}).json()["jobs"] == [client.get(path).json()]


def test_the_list_can_be_filtered_by_status(client: httpx.Client, finished_job: Callable[..., str]) -> None:
    paths: dict[Status, str] = {"succeeded": finished_job(), "queued": submit(client), "canceled": submit(client)}
    client.post(f"{paths['canceled']}/cancel")
    for status, path in paths.items():
        (job,) = client.get("/v1/jobs", params={"status": status}).json()["jobs"]
        assert job["links"]["self"] == path


def test_an_invalid_cursor_is_refused(client: httpx.Client) -> None:
    for cursor in ("x", "..", "../../etc", "0" * 32):
        problem(client.get("/v1/jobs", params={"cursor": cursor}), 422, "invalid_request")


def test_a_deleted_job_is_not_listed(client: httpx.Client) -> None:
    path, kept = submit(client), submit(client)
    client.delete(path)
    assert [job["links"]["self"] for job in client.get("/v1/jobs").json()["jobs"]] == [kept]


def test_waiting_jobs_have_a_queue_position(client: httpx.Client, queue: JobQueue) -> None:
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


def test_an_unchanged_document_is_not_sent_again(client: httpx.Client, queue: JobQueue) -> None:
    path = submit(client)
    for url in (path, "/v1/jobs"):
        first = client.get(url)
        again = client.get(url, headers={"If-None-Match": first.headers["ETag"]})
        assert (again.status_code, again.content) == (304, b"")
    queue.take(path.rpartition("/")[2], "worker", lease_s=30)
    assert client.get(path, headers={"If-None-Match": first.headers["ETag"]}).status_code == 200


def test_a_long_poll_ends_with_the_job_or_the_timeout(client: httpx.Client) -> None:
    path = submit(client)
    began_at = time.monotonic()
    assert client.get(path, params={"wait": 0.3}).json()["status"] == "queued"
    assert time.monotonic() - began_at >= 0.3
    client.post(f"{path}/cancel")
    assert client.get(path, params={"wait": 60}).json()["status"] == "canceled"
    problem(client.get(path, params={"wait": 601}), 422, "invalid_request")


def test_a_queued_job_is_canceled_immediately_and_permanently(client: httpx.Client, queue: JobQueue) -> None:
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


def test_concurrent_cancels_have_the_same_outcome(client: httpx.Client) -> None:
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
