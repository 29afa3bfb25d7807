"""The HTTP protocol of the server: a timeout for request heads, and problem documents for what is not HTTP."""

import asyncio

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol

from service.guard.headers import SECURITY_HEADERS
from service.problems import Problem

# From the connection, or from the first byte of a later request, to the end of the head: the default of Apache's
# mod_reqtimeout.
HEAD_TIMEOUT_S = 20.0
MAX_HEAD_BYTES = 128 * 1024  # of a request: h11's default of 16 KiB is too short for a URL with many splits or names


class HeadTimeoutProtocol(H11Protocol):
    """HTTP/1.1 of uvicorn that closes connections whose request head is not complete in time."""

    head_timeout_s = HEAD_TIMEOUT_S
    _timeout: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        super().connection_made(transport)
        self._start_timeout()

    def data_received(self, data: bytes) -> None:
        super().data_received(data)
        head_is_incomplete = self.cycle is None or self.cycle.response_complete
        if not head_is_incomplete:
            self._cancel_timeout()
        elif self._timeout is None:
            self._start_timeout()

    def connection_lost(self, exc: Exception | None) -> None:
        self._cancel_timeout()
        super().connection_lost(exc)

    def send_400_response(self, msg: str) -> None:  # noqa: ARG002
        """Respond to malformed HTTP with a problem document, as to every other error."""
        problem = Problem(
            "malformed_request",
            f"This is not an HTTP/1.1 request, or its head is longer than {MAX_HEAD_BYTES // 1024} KiB: send it again, "
            "well-formed.",
        )
        response = problem.response({**SECURITY_HEADERS, "Connection": "close"})
        head = h11.Response(status_code=response.status_code, headers=response.raw_headers, reason=b"Bad Request")
        for event in (head, h11.Data(data=bytes(response.body)), h11.EndOfMessage()):
            self.transport.write(self.conn.send(event) or b"")
        self.transport.close()

    def _start_timeout(self) -> None:
        self._timeout = self.loop.call_later(self.head_timeout_s, self.transport.close)

    def _cancel_timeout(self) -> None:
        if self._timeout is not None:
            self._timeout.cancel()
            self._timeout = None
