"""With API keys, each owner sees only their own jobs and has their own limits."""

from collections.abc import Iterator

import httpx
import pytest

from cleave.settings import Settings
from helpers.api import UNKNOWN, problem, submit
from helpers.servers import serving
from service.keys import key_digest, new_key

ANNA, BORIS = new_key(), new_key()
KEYS = f"anna:{key_digest(ANNA)}, boris:{key_digest(BORIS)}"


def bearer(key: str) -> dict[str, str]:
    return {"Authorization": f"Bearer {key}"}


@pytest.fixture
def guarded(settings: Settings) -> Iterator[httpx.Client]:
    with serving(settings.model_copy(update={"api_keys": KEYS})) as client:
        yield client


@pytest.mark.parametrize("headers", [{}, bearer("wrong"), {"Authorization": "Basic YTpi"}, bearer("\xff")])
def test_without_a_key_every_operation_on_jobs_is_unauthorized(guarded: httpx.Client, headers: dict[str, str]) -> None:
    raw = {name: value.encode("latin-1") for name, value in headers.items()}
    for method, path in (
        ("POST", "/v1/jobs"),
        ("GET", "/v1/jobs"),
        ("GET", UNKNOWN),
        ("DELETE", UNKNOWN),
        ("GET", f"{UNKNOWN}/labels"),
        ("GET", f"{UNKNOWN}/events"),
        ("GET", "/v1/webhooks/secret"),
        ("GET", "/metrics"),
    ):
        answer = guarded.request(method, path, headers=raw, content=b"abc" if method == "POST" else None)
        problem(answer, 401, "unauthorized")
        assert answer.headers["WWW-Authenticate"] == "Bearer"
    for path in ("/healthz", "/openapi.json", "/v1/formats", "/v1/methods"):
        assert guarded.get(path).status_code == 200


def test_jobs_belong_to_the_key_that_submitted_them(guarded: httpx.Client) -> None:
    guarded.headers.update(bearer(ANNA))
    path = submit(guarded)
    assert [job["links"]["self"] for job in guarded.get("/v1/jobs").json()["jobs"]] == [path]
    guarded.headers.update(bearer(BORIS))
    assert guarded.get("/v1/jobs").json()["jobs"] == []
    for answer in (
        guarded.get(path),
        guarded.get(f"{path}/labels"),
        guarded.get(f"{path}/events"),
        guarded.post(f"{path}/cancel"),
        guarded.delete(path),
    ):
        problem(answer, 404, "job_not_found")
    guarded.headers.update(bearer(ANNA))
    assert guarded.delete(path).status_code == 204
    problem(guarded.get(path), 410, "job_deleted")
    problem(guarded.get(path, headers=bearer(BORIS)), 404, "job_not_found")


def test_the_same_idempotency_key_of_two_callers_makes_two_jobs(guarded: httpx.Client) -> None:
    answers = [
        guarded.post("/v1/jobs", content=b"abc", headers={"Idempotency-Key": "k", **bearer(key)})
        for key in (ANNA, BORIS)
    ]
    assert len({answer.headers["Location"] for answer in answers}) == 2


def test_each_key_has_its_own_limit_of_jobs(settings: Settings) -> None:
    limits = {"api_keys": KEYS, "key_max_queued_jobs": 2, "max_queued_jobs": 3}
    with serving(settings.model_copy(update=limits)) as client:
        client.headers.update(bearer(ANNA))
        paths = [submit(client), submit(client)]
        refused = client.post("/v1/jobs", content=b"abc")
        problem(refused, 429, "too_many_jobs")
        assert refused.headers["RateLimit"] == '"jobs";r=0'
        assert int(refused.headers["Retry-After"]) > 0
        client.headers.update(bearer(BORIS))
        submit(client)
        problem(client.post("/v1/jobs", content=b"abc"), 429, "queue_full")
        client.delete(paths[0], headers=bearer(ANNA))
        submit(client)


def test_the_uploaded_bytes_of_an_hour_are_limited(settings: Settings) -> None:
    with serving(settings.model_copy(update={"key_upload_bytes_per_hour": 1000})) as client:
        first = client.post("/v1/jobs", content=b"x" * 600)
        assert '"upload";q=1000;qu="content-bytes";w=3600' in first.headers["RateLimit-Policy"]
        assert '"upload";r=400;t=' in first.headers["RateLimit"]
        refused = client.post("/v1/jobs", content=b"x" * 600)
        problem(refused, 429, "too_many_bytes")
        assert 0 < int(refused.headers["Retry-After"]) <= 3600
