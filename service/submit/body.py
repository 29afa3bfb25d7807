"""The body of a request as a stream of chunks, with a minimum speed."""

import asyncio
import time
from collections.abc import AsyncIterator

from fastapi import Request
from python_multipart.multipart import parse_options_header

from cleave.settings import Settings
from service.problems import Problem

_CHUNK_BYTES = 1024 * 1024  # handed to a thread at a time; set by hand


def media_type(request: Request) -> str:
    """Return the media type of the body without its options, empty if it is not declared."""
    return parse_options_header(request.headers.get("content-type"))[0].decode("latin-1")


def declared_length(request: Request) -> int:
    """Return the Content-Length, 0 if the length is not declared.

    Raises
    ------
    Problem
        If there is no body, or its length is not a number.
    """
    declared = request.headers.get("content-length")
    if declared is None:
        if "transfer-encoding" not in request.headers:
            raise Problem("length_required")
        return 0
    if not (declared.isascii() and declared.isdigit()):
        raise Problem("malformed_request", "The Content-Length is not a number.")
    return int(declared[:18])  # more digits are too many bytes in any case


async def body_chunks(request: Request, settings: Settings) -> AsyncIterator[bytes]:
    """Yield the body in chunks of about a megabyte.

    Raises
    ------
    Problem
        If the client stops sending, or sends more slowly than the settings allow.
    """
    stream = request.stream().__aiter__()
    began_at, received, pending = time.monotonic(), 0, bytearray()
    while True:
        try:
            async with asyncio.timeout(settings.upload_idle_s):
                data = await anext(stream)
        except TimeoutError:
            raise Problem("too_slow") from None
        except StopAsyncIteration:
            break
        received += len(data)
        elapsed_s = time.monotonic() - began_at
        if elapsed_s > settings.upload_idle_s and received < settings.upload_bytes_per_s * elapsed_s:
            raise Problem("too_slow")
        pending += data
        if len(pending) >= _CHUNK_BYTES:
            yield bytes(pending)
            pending.clear()
    if pending:
        yield bytes(pending)
