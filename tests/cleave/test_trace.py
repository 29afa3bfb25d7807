"""Trace contexts: a valid header is continued, an invalid one is ignored."""

import pytest

from cleave.trace import new_trace, parse_traceparent

TRACE, SPAN = "4bf92f3577b34da6a3ce929d0e0e4736", "00f067aa0ba902b7"


@pytest.mark.parametrize(
    "header", [f"00-{TRACE}-{SPAN}-01", f" 00-{TRACE}-{SPAN}-01 ", f"cc-{TRACE}-{SPAN}-01-what-ever"]
)
def test_a_valid_header_is_continued_with_a_span_of_its_own(header: str) -> None:
    parent = parse_traceparent(header)
    assert parent is not None
    child = parent.child()
    assert (child.trace_id, child.sampled) == (TRACE, True)
    assert child.span_id not in (SPAN, "0" * 16)
    assert parse_traceparent(child.traceparent()) == child


@pytest.mark.parametrize(
    "header",
    [
        None,
        "",
        "00",
        f"00-{TRACE.upper()}-{SPAN}-01",
        f"00-{'0' * 32}-{SPAN}-01",
        f"00-{TRACE}-{'0' * 16}-01",
        f"ff-{TRACE}-{SPAN}-01",
        f"00-{TRACE}-{SPAN}-01-more",
        f"00-{TRACE}-{SPAN}-01\nforged",
        f"00-{TRACE[:-1]}-{SPAN}-01",
    ],
)
def test_an_invalid_header_is_no_trace(header: str | None) -> None:
    assert parse_traceparent(header) is None


def test_new_traces_are_distinct_and_valid() -> None:
    assert new_trace().trace_id != new_trace().trace_id
    assert parse_traceparent(new_trace().traceparent()) is not None
