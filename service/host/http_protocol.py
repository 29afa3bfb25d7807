"""What never becomes a request: connections that say nothing, or spell out a head for hours, or speak no HTTP."""

import asyncio

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol

from service.guard.headers import SECURITY_HEADERS
from service.problems import Problem

HEAD_S = 20.0  # from the first byte, or from the connection, to the end of the head
LONGEST_HEAD_BYTES = 128 * 1024  # of a request; addresses with many splits or names are long


class ImpatientProtocol(H11Protocol):
    """HTTP/1.1 as uvicorn speaks it, with an end to its patience before a request has begun."""

    head_s = HEAD_S
    _waiting: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        super().connection_made(transport)
        self._waiting = self.loop.call_later(self.head_s, transport.close)

    def data_received(self, data: bytes) -> None:
        super().data_received(data)
        is_waiting = self.cycle is None or self.cycle.response_complete
        if not is_waiting:
            self._stop_waiting()
        elif self._waiting is None:
            self._waiting = self.loop.call_later(self.head_s, self.transport.close)

    def connection_lost(self, exc: Exception | None) -> None:
        self._stop_waiting()
        super().connection_lost(exc)

    def send_400_response(self, msg: str) -> None:  # noqa: ARG002
        """Answer what is no HTTP as every other mistake is answered."""
        most = LONGEST_HEAD_BYTES // 1024
        sentence = f"This is no request of HTTP/1.1, or its head is longer than {most} KiB: send it again, well-formed."
        problem = Problem("malformed_request", sentence)
        answer = problem.response({**SECURITY_HEADERS, "Connection": "close"})
        head = h11.Response(status_code=answer.status_code, headers=answer.raw_headers, reason=b"Bad Request")
        for event in (head, h11.Data(data=bytes(answer.body)), h11.EndOfMessage()):
            self.transport.write(self.conn.send(event) or b"")
        self.transport.close()

    def _stop_waiting(self) -> None:
        if self._waiting is not None:
            self._waiting.cancel()
            self._waiting = None
