"""What both clients share: requests, retries and streamed bodies."""

import asyncio
import os
from collections.abc import AsyncIterator, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeAlias

import httpx

from cleave.client.errors import ClientError, ServerUnreachable
from cleave.client.flows import Call, Submission, refusal

Mesh: TypeAlias = str | os.PathLike[str] | bytes  # a path, or the bytes of a file

# Files that belong to a mesh file; a mapping has them by their paths relative to it.
Companions: TypeAlias = Sequence[str | os.PathLike[str]] | Mapping[str, str | os.PathLike[str]]

CHUNK_BYTES = 256 * 1024  # of streamed files; set by hand
_RETRIED = (429, 502, 503, 504)  # the server, or a proxy in front of it, is busy or restarts
_FIRST_PAUSE_S = 0.25  # doubled after each attempt, if the server sends no Retry-After; set by hand
_LONGEST_PAUSE_S = 30.0  # set by hand


class Connection:
    """The URL, credentials, timeouts and retries of a client."""

    def __init__(self, url: str, api_key: str | None, timeout_s: float, retries: int) -> None:
        self.url = url.rstrip("/")
        self.headers = {} if api_key is None else {"Authorization": f"Bearer {api_key}"}
        self.timeout_s = timeout_s
        self.retries = retries

    def request(self, client: httpx.Client | httpx.AsyncClient, call: Call, content: Any) -> httpx.Request:
        headers = dict(call.headers)
        if call.body:
            headers["Content-Length"] = str(sum(map(_size, call.body)))
        return client.build_request(
            call.method,
            call.path,
            params=call.params,
            headers=headers,
            content=content,
            timeout=self.timeout_s + call.wait_s,
        )

    def pause_s(self, attempt: int, response: httpx.Response | None) -> float | None:
        """Return the pause before the next attempt; None if this was the last one or the response is final."""
        if response is not None and response.status_code not in _RETRIED:
            return None
        if attempt >= self.retries:
            return None
        retry_after = response.headers.get("Retry-After", "") if response is not None else ""
        return min(float(retry_after) if retry_after.isdigit() else _FIRST_PAUSE_S * 2**attempt, _LONGEST_PAUSE_S)

    def failure(self, response: httpx.Response | None, error: httpx.TransportError | None) -> ClientError:
        """Return the error to be raised after the last attempt."""
        if response is not None:
            return refusal(response)
        return ServerUnreachable(f"No response from {self.url} ({type(error).__name__}): is the server running?")


def submission_of(
    mesh: Mesh,
    *,
    parameters: Mapping[str, object] | None,
    format: str | None,  # noqa: A002
    unit: str | None,
    up: str | None,
    webhook: str | None = None,
    idempotency_key: str | None = None,
    recompute: bool = False,
    companions: Companions = (),
) -> Submission:
    source = mesh if isinstance(mesh, bytes) else Path(mesh)
    key = {} if idempotency_key is None else {"idempotency_key": idempotency_key}
    return Submission(
        mesh=source,
        companions=_named(source, companions),
        format=format,
        unit=unit,
        up=up,
        parameters=parameters or {},
        webhook=webhook,
        recompute=recompute,
        **key,
    )


def _named(mesh: Path | bytes, companions: Companions) -> dict[str, Path]:
    """The companions by their paths relative to the mesh, those of other folders by their names."""
    if isinstance(mesh, bytes):
        if companions:
            raise ValueError("Companions belong to a mesh file: give its path in place of its bytes.")
        return {}
    folder = mesh.absolute().parent
    if not isinstance(companions, Mapping):
        paths = [Path(path).absolute() for path in companions]
        companions = {
            path.relative_to(folder).as_posix() if path.is_relative_to(folder) else path.name: path for path in paths
        }
    return {name: Path(path) for name, path in companions.items()}


def chunks(body: Sequence[Path | bytes]) -> Iterator[bytes] | None:
    return _read(body) if body else None


def _read(body: Sequence[Path | bytes]) -> Iterator[bytes]:
    for piece in body:
        if isinstance(piece, bytes):
            if piece:
                yield piece
            continue
        with piece.open("rb") as file:
            while chunk := file.read(CHUNK_BYTES):
                yield chunk


def async_chunks(body: Sequence[Path | bytes]) -> AsyncIterator[bytes] | None:
    return _read_async(body) if body else None


async def _read_async(body: Sequence[Path | bytes]) -> AsyncIterator[bytes]:
    chunks = _read(body)
    while chunk := await asyncio.to_thread(next, chunks, b""):
        yield chunk


def _size(piece: Path | bytes) -> int:
    return len(piece) if isinstance(piece, bytes) else piece.stat().st_size


def partial_path(target: str | os.PathLike[str]) -> Path:
    path = Path(target)
    return path.with_name(f".{path.name}.{os.getpid()}.part")


def texts(params: Mapping[str, object]) -> dict[str, str | list[str]]:
    """Return query parameters as text; a list is repeated, None is left out."""
    given = {name: value for name, value in params.items() if value is not None}
    return {name: [*map(str, value)] if isinstance(value, list) else str(value) for name, value in given.items()}
