"""The body of a request, piece by piece, from clients that may be slow, endless or gone."""

import asyncio
import time
from collections.abc import AsyncIterator

from fastapi import Request

from cleave.settings import Settings
from service.problems import Problem

_PIECE_BYTES = 1024 * 1024  # handed on at a time


def declared_length(request: Request) -> int:
    """The Content-Length, 0 where the length is not declared.

    Raises
    ------
    Problem
        Where there is no body, or its length is not a number.
    """
    declared = request.headers.get("content-length")
    if declared is None:
        if "transfer-encoding" not in request.headers:
            raise Problem("length_required", "There is no body: send the mesh, with its Content-Length or in chunks.")
        return 0
    if not (declared.isascii() and declared.isdigit()):
        raise Problem("malformed_request", "The Content-Length is not a number.")
    return int(declared[:18])  # more digits are as much too large


async def pieces(request: Request, settings: Settings) -> AsyncIterator[bytes]:
    """The body in pieces of about a megabyte.

    Raises
    ------
    Problem
        Where the client falls silent, or sends so slowly that it only holds the connection.
    """
    stream = request.stream().__aiter__()
    began_at, received, piece = time.monotonic(), 0, bytearray()
    while True:
        try:
            chunk = await asyncio.wait_for(anext(stream), settings.upload_idle_s)
        except TimeoutError:
            raise _too_slow() from None
        except StopAsyncIteration:
            break
        received += len(chunk)
        took_s = time.monotonic() - began_at
        if took_s > settings.upload_idle_s and received < settings.upload_bytes_per_s * took_s:
            raise _too_slow()
        piece += chunk
        if len(piece) >= _PIECE_BYTES:
            yield bytes(piece)
            piece.clear()
    if piece:
        yield bytes(piece)


def _too_slow() -> Problem:
    return Problem("too_slow", "The upload came to a halt or is too slow: send it again over a better connection.")
