"""Bodies of requests: missing, endless, slow and interrupted ones."""

import asyncio
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
from starlette.requests import ClientDisconnect, Request

from cleave.settings import Settings
from helpers.api import traces
from helpers.uploads import CONTENT_TYPE, interrupted_request, part, post_form
from service.problems import Problem
from service.submit.request import receive_mesh
from worker.jobs.store.store import JobStore

LIMITED = Settings(max_upload_bytes=10_000, upload_idle_s=0.2)


def test_an_undeclared_length_is_limited_while_it_streams(client: httpx.Client, settings: Settings) -> None:
    sent = 0

    def endless() -> Iterator[bytes]:
        nonlocal sent
        yield part("mesh", b"")[:-2]
        for _ in range(100):
            sent += 1
            yield b"x" * 10_000

    assert post_form(client, endless()) == (413, "too_large")
    assert traces(settings.data_dir) == []


def test_an_interrupted_upload_leaves_no_files(store: JobStore, tmp_path: Path) -> None:
    request = interrupted_request(
        [part("mesh", b"half of a mesh")], content_type=CONTENT_TYPE, transfer_encoding="chunked"
    )

    async def receive() -> None:
        with store.spool.begin_upload() as upload:
            await receive_mesh(request, LIMITED, lambda: upload)

    with pytest.raises(ClientDisconnect):
        asyncio.run(receive())
    assert list((tmp_path / "data" / "incoming").iterdir()) == []


@pytest.mark.parametrize("length", ["10000000", "9" * 5000])
def test_a_declared_length_is_refused_before_the_body_is_read(store: JobStore, length: str) -> None:
    request = interrupted_request([], content_type=CONTENT_TYPE, content_length=length)

    async def receive() -> None:
        with store.spool.begin_upload() as upload:
            await receive_mesh(request, LIMITED, lambda: upload)

    with pytest.raises(Problem, match="larger than"):
        asyncio.run(receive())


def test_a_request_without_a_body_is_refused(store: JobStore) -> None:
    request = interrupted_request([], content_type=CONTENT_TYPE)

    async def receive() -> None:
        with store.spool.begin_upload() as upload:
            await receive_mesh(request, LIMITED, lambda: upload)

    with pytest.raises(Problem, match="no body") as refused:
        asyncio.run(receive())
    assert refused.value.code == "length_required"


def slow_request(pause_s: float) -> Request:
    """Return an endless request that sends a byte after every pause."""

    async def receive() -> dict[str, object]:
        await asyncio.sleep(pause_s)
        return {"type": "http.request", "body": b"x", "more_body": True}

    return Request({"type": "http", "method": "POST", "headers": [(b"transfer-encoding", b"chunked")]}, receive)


@pytest.mark.parametrize("pause_s", [60.0, 0.01])
def test_a_client_that_sends_hardly_anything_is_given_up(store: JobStore, tmp_path: Path, pause_s: float) -> None:
    async def receive() -> None:
        with store.spool.begin_upload() as upload:
            await receive_mesh(slow_request(pause_s), LIMITED, lambda: upload)

    with pytest.raises(Problem, match="slow") as refused:
        asyncio.run(receive())
    assert refused.value.code == "too_slow"
    assert list((tmp_path / "data" / "incoming").iterdir()) == []
