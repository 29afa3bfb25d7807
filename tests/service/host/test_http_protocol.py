"""The HTTP protocol of the server: a timeout for request heads, and problem documents for what is not HTTP."""

import json
import socket
from urllib.parse import urlsplit

import httpx
import pytest

from cleave.settings import Settings
from helpers.api import submit
from helpers.security_headers import check_security_headers
from helpers.servers import serving
from service.host.http_protocol import HeadTimeoutProtocol


@pytest.mark.parametrize(
    "beginning", [b"", b"GET / HTTP/1.1\r\nHost: x\r\n", b"GET /healthz HTTP/1.1\r\nHost: x\r\n\r\nGET"]
)
def test_a_connection_without_a_complete_request_head_is_closed(
    settings: Settings, monkeypatch: pytest.MonkeyPatch, beginning: bytes
) -> None:
    monkeypatch.setattr(HeadTimeoutProtocol, "head_timeout_s", 0.2)
    with serving(settings) as client:
        address = urlsplit(str(client.base_url))
        with socket.create_connection((str(address.hostname), int(str(address.port))), timeout=10) as connection:
            connection.sendall(beginning)
            while connection.recv(4096):
                pass


def test_the_head_timeout_does_not_stop_a_slow_response(settings: Settings, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(HeadTimeoutProtocol, "head_timeout_s", 0.1)
    with serving(settings) as client:
        path = submit(client)
        assert client.get(path, params={"wait": 0.5}).status_code == 200
        assert client.get(path).status_code == 200


@pytest.mark.parametrize(
    "sent", [b"GARBAGE\r\n\r\n", b"GET / HTTP/1.1\r\nHost: a\r\nHost: b\r\n\r\n", b"\x16\x03\x01\x02\r\n\r\n"]
)
def test_malformed_http_gets_a_problem_document_with_security_headers(client: httpx.Client, sent: bytes) -> None:
    address = (str(client.base_url.host), int(str(client.base_url.port)))
    with socket.create_connection(address) as connection, connection.makefile("rb") as answer:
        connection.sendall(sent)
        head, _, body = answer.read().partition(b"\r\n\r\n")
    assert head.startswith(b"HTTP/1.1 400 ")
    assert json.loads(body)["code"] == "malformed_request"
    headers = dict(line.split(": ", 1) for line in head.decode().splitlines()[1:])
    check_security_headers(httpx.Response(400, headers=headers, request=httpx.Request("GET", client.base_url)))
