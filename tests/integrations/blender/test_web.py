"""Every answer that is not a result becomes a sentence, and the key goes to no other server."""

import threading
import urllib.request
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import pytest

from integrations.blender.errors import CleaveError
from integrations.blender.web import RefusedError, is_loopback, send, server_url


class _Answers(BaseHTTPRequestHandler):
    """Answers with the status in the path; /N/W with a header Retry-After: W."""

    seen: list[str]

    def do_GET(self) -> None:
        type(self).seen.append(self.path)
        status, *after = self.path.strip("/").split("/")
        self.send_response(int(status))
        self.send_header("Location", f"http://{self.headers['Host']}/200")
        if after:
            self.send_header("Retry-After", after[0])
        self.end_headers()
        self.wfile.write(b'{"detail": "Say please."}' if status == "401" else b"<html>")

    def log_message(self, *_: object) -> None:
        """Write nothing."""


@pytest.fixture
def url() -> Iterator[str]:
    _Answers.seen = []
    server = ThreadingHTTPServer(("127.0.0.1", 0), _Answers)
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    yield f"http://127.0.0.1:{server.server_address[1]}"
    server.shutdown()
    server.server_close()
    thread.join()


def get(url: str) -> bytes:
    return send(urllib.request.Request(url), timeout_s=10.0)


def test_a_redirect_is_not_followed(url: str) -> None:
    with pytest.raises(RefusedError, match=f"enter the URL {url}/200"):
        get(f"{url}/307")
    assert _Answers.seen == ["/307"]


def test_the_sentence_of_the_server_is_shown(url: str) -> None:
    with pytest.raises(RefusedError, match=r"^Say please\. Enter the key in the preferences"):
        get(f"{url}/401")
    with pytest.raises(RefusedError, match="status 404: is the URL that of a Cleave server"):
        get(f"{url}/404")


@pytest.mark.parametrize(("path", "pause_s"), [("429/7", 7.0), ("503", 1.0), ("503/soon", 1.0), ("500/7", None)])
def test_a_busy_server_is_asked_again(url: str, path: str, pause_s: float | None) -> None:
    with pytest.raises(RefusedError) as refused:
        get(f"{url}/{path}")
    assert refused.value.retry_after_s == pause_s


def test_a_server_that_does_not_answer_is_named(url: str) -> None:
    nobody = url.rpartition(":")[0] + ":1"
    with pytest.raises(CleaveError, match=r"No answer from 127\.0\.0\.1:1 .*refused"):
        get(nobody)


@pytest.mark.parametrize("text", ["", "127.0.0.1:8000", "file:///etc/passwd", "http://", "http://a:b", "http://[1"])
def test_other_texts_are_no_servers(text: str) -> None:
    with pytest.raises(CleaveError, match="is no URL of a server"):
        server_url(text)


def test_a_url_has_no_slash_at_its_end() -> None:
    assert server_url(" https://example.org/cleave/ ") == "https://example.org/cleave"


def test_this_machine_needs_no_network() -> None:
    assert [is_loopback(url) for url in ("http://localhost:8000", "http://[::1]", "http://127.0.0.1:1")] == [True] * 3
    assert not is_loopback("http://localhost.example.org")
