"""Every error is a problem document."""

import httpx
import pytest

from helpers.api import UNKNOWN, problem
from worker.jobs.store.records import Records


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


def test_the_length_of_the_request_head_is_limited(client: httpx.Client) -> None:
    job = "/v1/jobs/" + "0" * 32
    splits = ",".join(map(str, range(7_000)))
    problem(client.get(f"{job}/labels", params={"splits": splits}), 404, "job_not_found")
    problem(client.get(f"{job}/labels", headers={"X-Long": "0" * 200_000}), 400, "malformed_request")
