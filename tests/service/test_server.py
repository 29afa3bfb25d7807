"""The process that answers HTTP: its metrics, and its patience."""

import socket
from urllib.parse import urlsplit

import httpx
import pytest

from cleave.settings import Settings
from helpers.api import samples, submit
from helpers.jobs import SMALL
from helpers.servers import serving
from service.host.http_protocol import ImpatientProtocol
from worker.jobs.queue.queue import JobQueue


def test_metrics_count_requests_by_route_and_tell_how_the_queue_is(client: httpx.Client, queue: JobQueue) -> None:
    path = submit(client)
    for _ in range(3):
        client.get(path)
    client.get("/nowhere")
    found = samples(client)
    assert found['cleave_requests_total{method="GET",route="/v1/jobs/{job_id}",status="200"}'] == 3
    assert found['cleave_requests_total{method="any",route="none",status="404"}'] == 1
    assert found['cleave_jobs_submitted_total{result="accepted"}'] == 1
    assert found["cleave_unfinished_jobs"] == found['cleave_waiting_jobs{queue="small"}'] == 1
    assert found['cleave_waiting_jobs{queue="large"}'] == 0
    assert found["cleave_oldest_unfinished_seconds"] > 0
    queue.entries[SMALL].pop_job_id()
    assert samples(client)['cleave_waiting_jobs{queue="small"}'] == 0


def test_metrics_are_told_without_the_queue_too(client_without_queue: httpx.Client) -> None:
    found = samples(client_without_queue)
    assert found["cleave_queue_up"] == 0
    assert 'cleave_waiting_jobs{queue="small"}' not in found
    assert "cleave_faces_total" not in found  # not 0, or it would seem to have jumped afterwards


@pytest.mark.parametrize(
    "beginning", [b"", b"GET / HTTP/1.1\r\nHost: x\r\n", b"GET /healthz HTTP/1.1\r\nHost: x\r\n\r\nGET"]
)
def test_who_never_comes_to_the_point_is_not_listened_to(
    settings: Settings, monkeypatch: pytest.MonkeyPatch, beginning: bytes
) -> None:
    monkeypatch.setattr(ImpatientProtocol, "head_s", 0.2)
    with serving(settings) as client:
        address = urlsplit(str(client.base_url))
        with socket.create_connection((str(address.hostname), int(str(address.port))), timeout=10) as connection:
            connection.sendall(beginning)
            while connection.recv(4096):
                pass


def test_an_answer_that_takes_long_is_waited_for(settings: Settings, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ImpatientProtocol, "head_s", 0.1)
    with serving(settings) as client:
        path = submit(client)
        assert client.get(path, params={"wait": 0.5}).status_code == 200
        assert client.get(path).status_code == 200


def test_head_is_get_without_the_body(client: httpx.Client) -> None:
    path = submit(client)
    for url in (path, "/openapi.json", "/nowhere"):
        whole, head = client.get(url), client.head(url)
        assert head.content == b""
        assert head.status_code == whole.status_code
        assert head.headers["Content-Length"] == whole.headers["Content-Length"]
