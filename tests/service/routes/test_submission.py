"""Ways to submit: to wait for the labels, to say it twice, to be given what was computed before."""

import threading
from collections.abc import Callable

import httpx
import pytest

from cleave.settings import Settings
from helpers.api import AGAIN, problem, submit
from helpers.jobs import SMALL, sphere
from helpers.servers import working
from helpers.waiting import wait_until
from service.submit.preference import Preference, read_preference
from worker.jobs.queue.queue import JobQueue
from worker.jobs.store.store import JobStore

MESH = sphere(12)


def test_who_waits_gets_the_labels_in_one_round_trip(client: httpx.Client, store: JobStore, settings: Settings) -> None:
    with working(store, settings):
        answer = client.post("/v1/jobs?segments=3", content=MESH, headers={"Prefer": "wait=60"})
    assert answer.status_code == 200
    assert answer.headers["Preference-Applied"] == "wait=60"
    job = answer.json()
    labels = client.get(job["links"]["labels"], params={"segments": 3}).json()
    assert (job["segments"], job["labels"]) == (3, labels["labels"])
    assert {**client.get(job["links"]["self"]).json(), **labels} == job


def test_who_waits_gets_the_labels_at_a_granularity(client: httpx.Client, store: JobStore, settings: Settings) -> None:
    with working(store, settings):
        answer = client.post("/v1/jobs?granularity=1", content=MESH, headers={"Prefer": "wait=60"})
    job = answer.json()
    assert job["segments"] == job["max_segments"] == len(set(job["labels"]))


def test_who_waits_in_vain_polls(client: httpx.Client) -> None:
    answer = client.post("/v1/jobs", content=MESH, headers={"Prefer": "wait=1"})
    assert answer.status_code == 202
    assert answer.json()["status"] == "queued"
    assert int(answer.headers["Retry-After"]) > 0


@pytest.mark.parametrize(
    ("prefer", "expected"),
    [
        (None, Preference(0.0, None)),
        ("respond-async", Preference(0.0, "respond-async")),
        ("wait=5", Preference(5.0, "wait=5")),
        ('respond-async, wait="5"', Preference(5.0, "wait=5")),
        ("wait=100000", Preference(60.0, "wait=60")),
        ("wait=0", Preference(0.0, "wait=0")),
        ("wait=-1, handling=lenient", Preference(0.0, None)),
        ("wait=five", Preference(0.0, None)),
    ],
)
def test_a_preference_is_what_the_header_says(prefer: str | None, expected: Preference) -> None:
    assert read_preference(prefer, 60.0) == expected


def test_what_was_computed_is_not_computed_again(
    client: httpx.Client, finished_job: Callable[..., str], queue: JobQueue
) -> None:
    path = finished_job(MESH)
    before = queue.entries[SMALL].get_job_ids()
    form = {"files": {"mesh": ("other.off", MESH)}}
    again = client.post("/v1/jobs", **form)  # type: ignore[arg-type]
    assert again.status_code == 200
    assert again.headers["Location"] == path
    assert again.json()["labels"] is None
    waited = client.post("/v1/jobs", **form, headers={"Prefer": "wait=1"})  # type: ignore[arg-type]
    assert len(waited.json()["labels"]) == waited.json()["mesh"]["faces"]
    assert queue.entries[SMALL].get_job_ids() == before
    for other in (
        client.post("/v1/jobs", **form, headers=AGAIN),  # type: ignore[arg-type]
        client.post("/v1/jobs", **form, data={"parameters": '{"seed": 3}'}),  # type: ignore[arg-type]
        client.post("/v1/jobs", content=sphere(11)),
    ):
        assert other.status_code == 202


def test_what_failed_or_is_gone_is_computed_again(client: httpx.Client, finished_job: Callable[..., str]) -> None:
    finished_job(b"PK\3\4")
    assert client.post("/v1/jobs", files={"mesh": ("mesh.off", b"PK\3\4")}).status_code == 202
    client.delete(finished_job(MESH))
    assert client.post("/v1/jobs", files={"mesh": ("mesh.off", MESH)}).status_code == 202


def test_a_request_that_is_sent_again_makes_no_second_job(client: httpx.Client, queue: JobQueue) -> None:
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


def test_of_many_requests_with_one_key_at_once_one_makes_the_job(client: httpx.Client, queue: JobQueue) -> None:
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


def test_a_key_that_was_answered_with_an_old_result_stands_for_it(
    client: httpx.Client, finished_job: Callable[..., str]
) -> None:
    path = finished_job(MESH)
    for _ in range(2):
        answer = client.post("/v1/jobs", files={"mesh": ("mesh.off", MESH)}, headers={"Idempotency-Key": "k"})
        assert (answer.status_code, answer.headers["Location"]) == (200, path)


def test_more_segments_than_the_hierarchy_will_have_are_refused_at_once(client: httpx.Client) -> None:
    problem(client.post("/v1/jobs?segments=65", content=MESH), 422, "invalid_parameters")
    assert client.get("/v1/jobs").json()["jobs"] == []


def test_a_waiting_request_ends_with_the_job_it_waits_for(client: httpx.Client) -> None:
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


def test_a_form_with_two_meshes_is_for_batches(client: httpx.Client) -> None:
    files = [("mesh", ("a.off", b"abc")), ("mesh", ("b.off", b"abc"))]
    body = problem(client.post("/v1/jobs", files=files), 400, "malformed_request")
    assert "/v1/batches" in str(body["detail"])


def test_submitting_needs_a_place_in_the_line(client: httpx.Client) -> None:
    headers = client.post("/v1/jobs", content=b"abc").headers
    assert headers["RateLimit-Policy"] == '"jobs";q=1000'
    assert headers["RateLimit"] == '"jobs";r=999'
    submit(client)
    assert client.post("/v1/jobs", content=b"abcd").headers["RateLimit"] == '"jobs";r=997'


def test_parameters_are_given_in_one_place(client: httpx.Client) -> None:
    answer = client.post(
        "/v1/jobs",
        params={"parameters": '{"max_segments": 5}'},
        data={"parameters": '{"max_segments": 6}'},
        files={"mesh": ("mesh.off", MESH)},
    )
    problem(answer, 422, "invalid_parameters")


def test_the_head_of_a_request_may_be_long_but_not_endless(client: httpx.Client) -> None:
    job = "/v1/jobs/" + "0" * 32
    splits = ",".join(map(str, range(7_000)))
    problem(client.get(f"{job}/labels", params={"splits": splits}), 404, "job_not_found")
    problem(client.get(f"{job}/labels", headers={"X-Long": "0" * 200_000}), 400, "malformed_request")
