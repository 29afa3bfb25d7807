"""Webhooks: signed as in the standard, retried, and never sent to private addresses."""

import os
import socket
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path
from typing import Any

import httpx
import pytest
from standardwebhooks import Webhook, WebhookVerificationError

from cleave.settings import Settings
from helpers.api import problem
from helpers.jobs import sphere
from helpers.servers import serving
from helpers.waiting import wait_until
from worker.jobs.job import now
from worker.jobs.queue.locks import Locks
from worker.jobs.queue.queue import JobQueue
from worker.jobs.store.opening import open_folder
from worker.jobs.store.store import JobStore
from worker.process.perform import perform
from worker.webhooks.delivery import BACK_OFF_S, WebhookSender
from worker.webhooks.message import Undeliverable, objection_to, send


class Receiver:
    """An HTTP server that records requests and responds with the given statuses, then with 200."""

    def __init__(self, *statuses: int) -> None:
        self.answers = threading.Lock()  # whoever holds it delays the answers
        self.received: list[tuple[dict[str, str], bytes]] = []
        left = list(statuses)

        class Handler(BaseHTTPRequestHandler):
            def do_POST(handler) -> None:  # noqa: N805
                body = handler.rfile.read(int(handler.headers["Content-Length"]))
                self.received.append((dict(handler.headers.items()), body))
                with self.answers:
                    handler.send_response(left.pop(0) if left else 200)
                handler.send_header("Location", "http://127.0.0.1:1/")
                handler.end_headers()

            def log_message(self, *_: Any) -> None:
                pass

        self.server = HTTPServer(("127.0.0.1", 0), Handler)
        self.url = f"http://localhost:{self.server.server_port}/hook?a=b"


@contextmanager
def receiving(*statuses: int) -> Iterator[Receiver]:
    receiver = Receiver(*statuses)
    thread = threading.Thread(target=receiver.server.serve_forever)
    thread.start()
    try:
        yield receiver
    finally:
        receiver.server.shutdown()
        thread.join()
        receiver.server.server_close()


@pytest.fixture
def inside(settings: Settings) -> Settings:
    """Settings that allow webhooks to this machine."""
    return settings.model_copy(update={"webhook_private_targets": True})


@pytest.fixture
def sender(store: JobStore, queue: JobQueue, inside: Settings) -> WebhookSender:
    return WebhookSender(store, Locks(queue.connection), inside, "sender")


@pytest.fixture
def finished_with_webhook(inside: Settings, store: JobStore) -> Callable[[str], tuple[str, str]]:
    def submit(url: str) -> tuple[str, str]:
        """Return the id of a finished job and the secret of its webhooks."""
        with serving(inside) as client:
            answer = client.post("/v1/jobs", params={"webhook": url}, content=sphere(12))
            assert answer.status_code == 202, answer.text
            perform(store, inside, answer.json()["id"], lambda *_: None)
            return answer.json()["id"], client.get("/v1/webhooks/secret").json()["secret"]

    return submit


def test_a_webhook_is_told_once_and_can_verify_who_told_it(
    sender: WebhookSender, finished_with_webhook: Callable[[str], tuple[str, str]]
) -> None:
    with receiving() as receiver:
        job_id, secret = finished_with_webhook(receiver.url)
        at_s = now().timestamp()
        sender.send_due(at_s)
        sender.send_due(at_s)
    ((headers, body),) = receiver.received
    message = Webhook(secret).verify(body, headers)
    assert (message["type"], message["data"]["id"]) == ("job.succeeded", job_id)
    assert headers["Host"] == receiver.url.split("/")[2]
    with pytest.raises(WebhookVerificationError):
        Webhook(secret).verify(body.replace(b"succeeded", b"failed"), headers)


def test_a_failed_webhook_is_retried_with_growing_pauses_and_the_same_id(
    sender: WebhookSender, finished_with_webhook: Callable[[str], tuple[str, str]]
) -> None:
    with receiving(500, 302) as receiver:
        finished_with_webhook(receiver.url)
        at_s = now().timestamp()
        for due_s in (0.0, BACK_OFF_S[0], BACK_OFF_S[0] + BACK_OFF_S[1]):
            sender.send_due(at_s + due_s)
            sender.send_due(at_s + due_s + 1)
    assert len(receiver.received) == 3
    assert len({headers["webhook-id"] for headers, _ in receiver.received}) == 1
    assert len({headers["webhook-timestamp"] for headers, _ in receiver.received}) == 3
    assert sender.store.outbox.job_ids() == set()


def test_a_webhook_that_always_fails_is_abandoned(
    sender: WebhookSender, finished_with_webhook: Callable[[str], tuple[str, str]]
) -> None:
    job_id, _ = finished_with_webhook("http://127.0.0.1:1/nobody")
    at_s = now().timestamp()
    for pause_s in (0.0, *BACK_OFF_S):
        assert job_id in sender.store.outbox.job_ids()
        at_s += pause_s
        sender.send_due(at_s)
    assert sender.store.outbox.job_ids() == set()


def test_no_message_is_sent_before_the_job_has_ended(sender: WebhookSender, inside: Settings) -> None:
    with receiving() as receiver, serving(inside) as client:
        answer = client.post("/v1/jobs", params={"webhook": receiver.url}, content=b"abc")
        sender.send_due(now().timestamp())
        assert receiver.received == []
        client.post(f"{answer.headers['Location']}/cancel")
        sender.send_due(now().timestamp())
    assert b"job.canceled" in receiver.received[0][1]


def test_a_deleted_job_leaves_no_message(
    sender: WebhookSender, finished_with_webhook: Callable[[str], tuple[str, str]], inside: Settings
) -> None:
    job_id, _ = finished_with_webhook("http://127.0.0.1:1/nobody")
    with serving(inside) as client:
        client.delete(f"/v1/jobs/{job_id}").raise_for_status()
    assert sender.store.outbox.job_ids() == set()


def test_a_message_on_its_way_when_the_sender_is_stopped_is_not_sent_again(
    sender: WebhookSender, finished_with_webhook: Callable[[str], tuple[str, str]], inside: Settings
) -> None:
    settings = {"CLEAVE_DATA_DIR": str(inside.data_dir), "CLEAVE_REDIS_URL": str(inside.redis_url)}
    settings["CLEAVE_WEBHOOK_PRIVATE_TARGETS"] = "true"
    with receiving() as receiver, receiver.answers:  # so that none is answered
        finished_with_webhook(receiver.url)
        with subprocess.Popen([sys.executable, "-m", "worker.webhooks"], env=os.environ | settings) as process:
            wait_until(lambda: receiver.received)
            process.terminate()
            receiver.answers.release()
            assert process.wait(30) == 0
            receiver.answers.acquire()
    assert len(receiver.received) == 1
    assert sender.store.outbox.job_ids() == set()


@pytest.mark.parametrize(
    "url",
    [
        "ftp://example.com/",
        "example.com/hook",
        "http://",
        "http://user:secret@example.com/",
        "http://127.0.0.1/",
        "http://localhost/",
        "http://[::1]/",
        "http://[::ffff:127.0.0.1]/",
        "http://169.254.169.254/latest/meta-data",
        "http://10.1.2.3/",
        "http://192.168.0.1:8080/",
        "http://0.0.0.0/",
        "http://224.0.0.1/",
        "http://[fe80::1]/",
        "http://example.com:99999/",
        "http://exa mple.com/",
        "http://example.com/\nHost: other",
    ],
)
def test_a_webhook_that_can_be_seen_to_lead_inwards_is_refused(client: httpx.Client, url: str) -> None:
    problem(client.post("/v1/jobs", params={"webhook": url}, content=b"abc"), 422, "invalid_parameters")
    assert objection_to("https://example.com/hook?x=1", False) is None


def test_a_name_that_leads_inwards_is_not_followed(monkeypatch: pytest.MonkeyPatch) -> None:
    def resolve(*_: Any, **__: Any) -> list[Any]:
        return [(socket.AF_INET, socket.SOCK_STREAM, 6, "", (address, 80)) for address in ("93.184.216.34", "10.0.0.1")]

    monkeypatch.setattr(socket, "getaddrinfo", resolve)
    with pytest.raises(Undeliverable, match="not public"):
        send("http://harmless.example/", "msg_1", b"secret", b"{}", now(), private_targets=False)


def test_a_message_is_stored_until_it_is_delivered(tmp_path: Path, sender: WebhookSender, inside: Settings) -> None:
    """A sender that dies in the middle does not lose the message."""
    with serving(inside) as client:
        client.post("/v1/jobs", params={"webhook": "http://127.0.0.1:1/"}, content=b"abc")
    assert len(open_folder(tmp_path / "data").outbox.job_ids()) == len(sender.store.outbox.job_ids()) == 1
