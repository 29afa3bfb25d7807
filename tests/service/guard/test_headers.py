"""Every response has security headers, also errors; HEAD is answered as GET without a body."""

from collections.abc import Callable

import httpx
import pytest

from cleave.settings import Settings
from helpers.api import UNKNOWN, submit
from helpers.security_headers import check_security_headers
from helpers.servers import serving
from worker.jobs.store.records import Records


def test_every_operation_and_every_page_has_security_headers(
    client: httpx.Client, finished_job: Callable[..., str]
) -> None:
    job_id = finished_job().rpartition("/")[2]
    paths = client.get("/openapi.json").json()["paths"]
    known = {path.replace("{job_id}", job_id) for path, operations in paths.items() if "get" in operations}
    assert len(known) > 15
    for path in sorted(known | {"/", "/docs", "/viewer/page.js", "/nowhere", f"/v1/jobs/{'0' * 32}", "/v1/jobs/%00"}):
        check_security_headers(client.get(path, params={"limit": 5} if path.endswith("jobs") else None))


def test_the_policy_allows_only_this_server(client: httpx.Client) -> None:
    for path in ("/v1/formats", UNKNOWN, "/nowhere", "/openapi.json"):
        headers = client.get(path).headers
        assert headers["X-Content-Type-Options"] == "nosniff"
        assert "default-src 'self'" in headers["Content-Security-Policy"]
        assert "unsafe" not in headers["Content-Security-Policy"]


def test_refused_requests_have_security_headers(client: httpx.Client) -> None:
    for answer in (
        client.put("/v1/jobs"),
        client.options("/v1/jobs"),
        client.head("/"),
        client.post("/v1/jobs"),
        client.post("/v1/jobs", content=bytes(300_000), headers={"Content-Type": "model/stl"}),
        client.post("/v1/jobs", content=b"x", headers={"Content-Type": "model/stl", "Origin": "http://elsewhere"}),
        client.get("/" + "x" * 5000),
    ):
        assert answer.status_code >= 200
        check_security_headers(answer)


def test_an_internal_error_has_security_headers(client: httpx.Client, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr(Records, "job", fail)
    answer = client.get(f"/v1/jobs/{'0' * 32}")
    assert (answer.status_code, answer.json()["code"]) == (500, "internal_error")
    check_security_headers(answer)


def test_responses_have_security_headers_while_the_queue_is_down(client_without_queue: httpx.Client) -> None:
    for path in ("/readyz", "/healthz", "/metrics"):
        check_security_headers(client_without_queue.get(path))
    refused = client_without_queue.post("/v1/jobs", content=b"x", headers={"Content-Type": "model/stl"})
    assert refused.status_code == 503
    assert int(refused.headers["Retry-After"]) > 0
    check_security_headers(refused)


def test_the_response_of_a_full_queue_has_security_headers_and_retry_after(settings: Settings) -> None:
    with serving(settings.model_copy(update={"max_queued_jobs": 1})) as client:
        stl = {"Content-Type": "model/stl"}
        assert client.post("/v1/jobs", content=b"x", headers=stl).status_code == 202
        refused = client.post("/v1/jobs", content=b"y", headers=stl)
        assert (refused.status_code, refused.json()["code"]) == (429, "queue_full")
        assert int(refused.headers["Retry-After"]) > 0
        check_security_headers(refused)


def test_head_is_get_without_the_body(client: httpx.Client) -> None:
    path = submit(client)
    for url in (path, "/openapi.json", "/nowhere"):
        whole, head = client.get(url), client.head(url)
        assert head.content == b""
        assert head.status_code == whole.status_code
        assert head.headers["Content-Length"] == whole.headers["Content-Length"]
