"""Traces as in W3C Trace Context, level 1, which connect the log lines of several processes about one request.

A client or a proxy sends a ``traceparent``; if there is none, the service begins a trace. It is stored with the job, so
that the worker, its work-horse and the janitor log under the trace of the request.
"""

import re
import secrets
from dataclasses import dataclass

_PARENT = re.compile(
    r"(?!ff)([0-9a-f]{2})-(?!0{32})([0-9a-f]{32})-(?!0{16})([0-9a-f]{16})-([0-9a-f]{2})(-.*)?", re.ASCII
)
_FIRST_VERSION = "00"
_SAMPLED = 0x01


@dataclass(frozen=True, slots=True)
class Trace:
    """One span of a trace."""

    trace_id: str  # 32 hexadecimal digits, the same for everything that belongs to a request
    span_id: str  # 16 hexadecimal digits
    sampled: bool = False  # whether the caller may record the trace

    def child(self) -> "Trace":
        """Return a new span of the same trace."""
        return Trace(self.trace_id, secrets.token_hex(8), self.sampled)

    def traceparent(self) -> str:
        return f"{_FIRST_VERSION}-{self.trace_id}-{self.span_id}-{_SAMPLED if self.sampled else 0:02x}"


def new_trace() -> Trace:
    return Trace(secrets.token_hex(16), secrets.token_hex(8))


def parse_traceparent(header: str | None) -> Trace | None:
    """Return the trace of a header; None if the header is missing or invalid, and a new trace has to be begun."""
    match = _PARENT.fullmatch((header or "").strip())
    if match is None or (match[1] == _FIRST_VERSION and match[5]):
        return None
    return Trace(match[2], match[3], bool(int(match[4], 16) & _SAMPLED))
