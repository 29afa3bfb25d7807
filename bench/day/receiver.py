"""A receiver of webhooks that can refuse messages, or be away, and comes back."""

import json
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

from bench.day.proxies import free_port


@dataclass(frozen=True, slots=True)
class Message:
    """A message as it arrived."""

    path: str
    headers: dict[str, str]  # their names in small letters
    body: bytes
    is_accepted: bool

    @property
    def job_id(self) -> str:
        return str(self._document["data"]["id"])

    @property
    def status(self) -> str:
        return str(self._document["data"]["status"])

    @property
    def _document(self) -> dict[str, Any]:
        document: dict[str, Any] = json.loads(self.body)
        return document


@dataclass(slots=True)
class Receiver:
    """A server that keeps all messages, between open and close. While it ``refuses``, it accepts none that is new."""

    port: int = field(default_factory=free_port)
    messages: list[Message] = field(default_factory=list)
    refuses: bool = False
    _server: ThreadingHTTPServer | None = None

    def url(self, name: str) -> str:
        return f"http://127.0.0.1:{self.port}/{name}"

    def is_new(self, message_id: str) -> bool:
        return all(message.headers["webhook-id"] != message_id for message in self.messages)

    def accepted(self) -> list[Message]:
        return [message for message in self.messages if message.is_accepted]

    def has_refused(self) -> bool:
        return not all(message.is_accepted for message in self.messages)

    def open(self) -> None:
        self._server = _Server(("127.0.0.1", self.port), self)
        threading.Thread(target=self._server.serve_forever, kwargs={"poll_interval": 0.05}).start()

    def close(self) -> None:
        if self._server is not None:
            self._server.shutdown()
            self._server.server_close()
            self._server = None


@contextmanager
def receiving() -> Iterator[Receiver]:
    """Open a receiver, and close it at the end."""
    receiver = Receiver()
    receiver.open()
    try:
        yield receiver
    finally:
        receiver.close()


class _Server(ThreadingHTTPServer):
    allow_reuse_address = True

    def __init__(self, address: tuple[str, int], receiver: Receiver) -> None:
        self.receiver = receiver
        super().__init__(address, _Handler)


class _Handler(BaseHTTPRequestHandler):
    server: _Server

    def do_POST(self) -> None:  # the name that http.server requires
        receiver = self.server.receiver
        body = self.rfile.read(int(self.headers["Content-Length"]))
        headers = {name.lower(): value for name, value in self.headers.items()}
        is_accepted = not (receiver.refuses and receiver.is_new(headers["webhook-id"]))
        receiver.messages.append(Message(self.path, headers, body, is_accepted))
        self.send_response(204 if is_accepted else 503)
        self.end_headers()

    def log_message(self, format: str, *arguments: object) -> None:  # noqa: A002
        """Log nothing."""
