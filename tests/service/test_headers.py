"""Every page and every answer, also of an error, says what a browser may do with it."""

import json
import socket
from collections.abc import Callable

import httpx
import pytest

from cleave.settings import Settings
from helpers.servers import serving
from worker.jobs.store.records import Records

POLICY = ("form-action 'self'", "base-uri 'none'", "frame-ancestors 'none'")


def check(answer: httpx.Response) -> None:
    policy = answer.headers["Content-Security-Policy"]
    assert policy.startswith(("default-src 'self'", "default-src 'none'")), answer.request.url
    assert all(part in policy for part in POLICY)
    assert "unsafe" not in policy
    assert "http" not in policy
    assert answer.headers["X-Content-Type-Options"] == "nosniff"
    assert answer.headers["Referrer-Policy"] == "no-referrer"
    assert answer.headers["Cross-Origin-Opener-Policy"] == "same-origin"


def test_every_operation_and_every_page_has_security_headers(
    client: httpx.Client, finished_job: Callable[..., str]
) -> None:
    job_id = finished_job().rpartition("/")[2]
    paths = client.get("/openapi.json").json()["paths"]
    known = {path.replace("{job_id}", job_id) for path, operations in paths.items() if "get" in operations}
    assert len(known) > 15
    for path in sorted(known | {"/", "/docs", "/viewer/page.js", "/nowhere", f"/v1/jobs/{'0' * 32}", "/v1/jobs/%00"}):
        check(client.get(path, params={"limit": 5} if path.endswith("jobs") else None))


def test_refusals_have_them_too(client: httpx.Client) -> None:
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
        check(answer)


def test_an_error_that_nobody_expects_has_them_too(client: httpx.Client, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr(Records, "job", fail)
    answer = client.get(f"/v1/jobs/{'0' * 32}")
    assert (answer.status_code, answer.json()["code"]) == (500, "internal_error")
    check(answer)


def test_without_a_queue_they_stay(client_without_queue: httpx.Client) -> None:
    for path in ("/readyz", "/healthz", "/metrics"):
        check(client_without_queue.get(path))
    refused = client_without_queue.post("/v1/jobs", content=b"x", headers={"Content-Type": "model/stl"})
    assert refused.status_code == 503
    assert int(refused.headers["Retry-After"]) > 0
    check(refused)


def test_a_full_queue_says_when_to_come_again(settings: Settings) -> None:
    with serving(settings.model_copy(update={"max_queued_jobs": 1})) as client:
        stl = {"Content-Type": "model/stl"}
        assert client.post("/v1/jobs", content=b"x", headers=stl).status_code == 202
        refused = client.post("/v1/jobs", content=b"y", headers=stl)
        assert (refused.status_code, refused.json()["code"]) == (429, "queue_full")
        assert int(refused.headers["Retry-After"]) > 0
        check(refused)


@pytest.mark.parametrize(
    "sent", [b"GARBAGE\r\n\r\n", b"GET / HTTP/1.1\r\nHost: a\r\nHost: b\r\n\r\n", b"\x16\x03\x01\x02\r\n\r\n"]
)
def test_what_is_no_http_is_told_so_with_them(client: httpx.Client, sent: bytes) -> None:
    address = (str(client.base_url.host), int(str(client.base_url.port)))
    with socket.create_connection(address) as connection, connection.makefile("rb") as answer:
        connection.sendall(sent)
        head, _, body = answer.read().partition(b"\r\n\r\n")
    assert head.startswith(b"HTTP/1.1 400 ")
    assert json.loads(body)["code"] == "malformed_request"
    headers = dict(line.split(": ", 1) for line in head.decode().splitlines()[1:])
    check(httpx.Response(400, headers=headers, request=httpx.Request("GET", client.base_url)))
