"""An S3 server for the tests, in a separate process."""

import os
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager

import httpx

from helpers.waiting import wait_until

CREDENTIALS = {"AWS_ACCESS_KEY_ID": "tester", "AWS_SECRET_ACCESS_KEY": "secret"}
_BUCKET = "cleave-test"


@contextmanager
def s3_server() -> Iterator[tuple[str, "subprocess.Popen[bytes]"]]:
    """Start an S3 server; yield the URL of a bucket and the process of the server."""
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    process = subprocess.Popen(
        [sys.executable, "-m", "moto.server", "-H", "127.0.0.1", "-p", str(port)],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env=os.environ | CREDENTIALS,
    )
    endpoint = f"http://127.0.0.1:{port}"
    try:
        wait_until(lambda: _is_answering(endpoint))
        httpx.put(f"{endpoint}/{_BUCKET}").raise_for_status()
        yield f"s3://{_BUCKET}/tests?endpoint={endpoint}", process
    finally:
        process.kill()
        process.wait()


def below(url: str, name: str) -> str:
    """Return the URL of a bucket with a name added to its prefix."""
    path, question_mark, query = url.partition("?")
    return f"{path}/{name}{question_mark}{query}"


def _is_answering(endpoint: str) -> bool:
    try:
        return httpx.get(f"{endpoint}/moto-api/").status_code == 200
    except httpx.TransportError:
        return False
