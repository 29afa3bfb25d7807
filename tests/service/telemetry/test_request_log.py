"""A request is recorded in the log, in the metrics and in its trace."""

import json
import logging
from collections.abc import Callable
from typing import Any

import httpx
import pytest

from cleave.logs import JsonFormatter
from cleave.trace import parse_traceparent
from helpers.api import UNKNOWN, submit
from helpers.jobs import sphere
from helpers.waiting import wait_until
from worker.jobs.queue.queue import JobQueue
from worker.jobs.store.records import Records
from worker.jobs.store.store import JobStore

PARENT = "00-4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-01"
TRACE_ID = PARENT.split("-")[1]


@pytest.fixture
def logged(monkeypatch: pytest.MonkeyPatch) -> list[dict[str, Any]]:
    """The lines that the application logs as JSON."""
    documents: list[dict[str, Any]] = []

    class Collector(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            documents.append(json.loads(JsonFormatter("service").format(record)))

    logger = logging.getLogger("cleave")
    monkeypatch.setattr(logger, "handlers", [Collector()])
    monkeypatch.setattr(logger, "level", logging.DEBUG)
    logger.manager._clear_cache()  # type: ignore[attr-defined]
    return documents


def lines_of(logged: list[dict[str, Any]], route: str, count: int) -> list[dict[str, Any]]:
    """Wait for the lines of the requests of a route, which are logged shortly after their responses."""
    wait_until(lambda: sum(line.get("route") == route for line in logged) >= count)
    return [line for line in logged if line.get("route") == route]


def test_the_trace_of_a_client_is_in_the_job_the_response_and_the_log(
    client: httpx.Client, store: JobStore, logged: list[dict[str, Any]]
) -> None:
    answer = client.post("/v1/jobs", content=sphere(12), headers={"traceparent": PARENT, "Content-Type": "model/off"})
    job_id = answer.json()["id"]
    answered = parse_traceparent(answer.headers["traceparent"])
    job = store.records.job(job_id)
    assert answered is not None
    assert job is not None
    assert answered.trace_id == TRACE_ID
    assert job.traceparent == answer.headers["traceparent"]
    lines_of(logged, "/v1/jobs", 1)
    assert {line["message"] for line in logged} == {"accepted", "POST /v1/jobs"}
    assert {(line["job_id"], line["trace_id"]) for line in logged} == {(job_id, TRACE_ID)}


def test_each_request_without_a_valid_trace_starts_its_own(client: httpx.Client) -> None:
    traces = [client.get("/healthz").headers["traceparent"] for _ in range(2)]
    assert len({trace.split("-")[1] for trace in traces}) == 2
    forged = client.get("/healthz", headers={"traceparent": "00-nonsense"}).headers["traceparent"]
    assert parse_traceparent(forged) is not None


def test_requests_for_a_job_are_logged_with_its_id(client: httpx.Client, logged: list[dict[str, Any]]) -> None:
    path = submit(client)
    client.get(path)
    client.head(path)
    lines = lines_of(logged, "/v1/jobs/{job_id}", 2)
    assert [line["method"] for line in lines] == ["GET", "GET"]  # HEAD is handled as GET
    assert {(line["job_id"], line["level"]) for line in lines} == {(path.rpartition("/")[2], "debug")}


def test_an_internal_error_is_counted_and_logged_with_its_trace(
    client: httpx.Client, logged: list[dict[str, Any]], monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise ZeroDivisionError("secret")

    monkeypatch.setattr(Records, "job", fail)
    answer = client.get(UNKNOWN, headers={"traceparent": PARENT})
    assert answer.status_code == 500
    assert answer.json()["code"] == "internal_error"
    assert answer.headers["X-Content-Type-Options"] == "nosniff"
    assert answer.headers["traceparent"].split("-")[1] == TRACE_ID
    (line,) = lines_of(logged, "/v1/jobs/{job_id}", 1)
    assert line["level"] == "warning"
    assert "ZeroDivisionError" in logged[0]["exception"]
    assert [line["trace_id"] for line in logged] == [TRACE_ID, TRACE_ID]
    assert 'status="500"' in client.get("/metrics").text


def test_unknown_methods_and_paths_do_not_add_labels_to_the_metrics(client: httpx.Client) -> None:
    client.request("GET", "/healthz")
    before = client.get("/metrics").text.count("cleave_requests_total{")
    for number in range(5):
        client.request(f"EVIL{number}", "/v1/jobs")
        client.request(f"EVIL{number}", f"/nowhere/{number}")
    assert client.get("/metrics").text.count("cleave_requests_total{") - before <= 3


def test_a_job_that_cannot_be_enqueued_is_logged(
    client: httpx.Client, logged: list[dict[str, Any]], monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object, **__: object) -> Callable[[], None]:
        raise ConnectionError("gone")

    monkeypatch.setattr(JobQueue, "enqueue", fail)
    monkeypatch.setattr("service.submit.intake.QueueError", ConnectionError)
    submit(client)
    assert any("janitor" in line["message"] for line in logged)
