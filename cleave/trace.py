"""What ties together the lines that several processes log about one request: the trace of W3C Trace Context, level 1.

A client, or the proxy in front of the service, sends a ``traceparent``; where none comes, the service begins a trace.
The job keeps it, so the worker, its work-horse and the janitor log under the same trace as the request.
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

    trace_id: str  # 32 hexadecimal digits, the same for everything that a request causes
    span_id: str  # 16 of them, of this step
    sampled: bool = False  # whether whoever began the trace records it

    def child(self) -> "Trace":
        """A step that this one causes."""
        return Trace(self.trace_id, secrets.token_hex(8), self.sampled)

    def traceparent(self) -> str:
        return f"{_FIRST_VERSION}-{self.trace_id}-{self.span_id}-{_SAMPLED if self.sampled else 0:02x}"


def new_trace() -> Trace:
    return Trace(secrets.token_hex(16), secrets.token_hex(8))


def parse_traceparent(header: str | None) -> Trace | None:
    """The trace of a header; None where there is none or it is not valid, upon which a new one is to be begun."""
    match = _PARENT.fullmatch((header or "").strip())
    if match is None or (match[1] == _FIRST_VERSION and match[5]):
        return None
    return Trace(match[2], match[3], bool(int(match[4], 16) & _SAMPLED))
