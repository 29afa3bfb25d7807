"""The log: every line contains its job and trace, and messages cannot forge lines."""

import json
import logging
import os
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from cleave.logs import JsonFormatter, TextFormatter, about, current_traceparent, note_job
from cleave.trace import Trace, new_trace

log = logging.getLogger("cleave.test")


class Lines(logging.Handler):
    def __init__(self, formatter: logging.Formatter) -> None:
        super().__init__()
        self.setFormatter(formatter)
        self.lines: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        self.lines.append(self.format(record))


@pytest.fixture
def trace() -> Trace:
    return new_trace()


@contextmanager
def logging_as(formatter: logging.Formatter) -> Iterator[list[str]]:
    """Yield the lines that are logged in this context."""
    handler = Lines(formatter)
    log.addHandler(handler)
    log.setLevel(logging.INFO)
    log.propagate = False  # reports of tests cannot contain every character that a line may
    try:
        yield handler.lines
    finally:
        log.propagate = True
        log.removeHandler(handler)


@pytest.fixture(params=[JsonFormatter("worker"), TextFormatter()], ids=["json", "text"])
def lines(request: pytest.FixtureRequest) -> Iterator[list[str]]:
    with logging_as(request.param) as lines:
        yield lines


def test_a_line_contains_its_job_and_trace(lines: list[str], trace: Trace) -> None:
    with about("a" * 32, trace.traceparent()):
        log.info("inside")
    log.info("outside")
    assert "a" * 32 in lines[0]
    assert trace.trace_id in lines[0]
    assert "a" * 32 not in lines[1]


def test_the_job_can_be_set_during_a_request(lines: list[str], trace: Trace) -> None:
    note_job("ignored")
    with about(trace=trace) as subject:
        note_job("b" * 32)
        log.info("now it is known")
    assert "b" * 32 in lines[0]
    assert subject.job_id == "b" * 32


def test_a_forked_work_horse_logs_the_same_job_and_trace(trace: Trace) -> None:
    reading, writing = os.pipe()
    with about("c" * 32, trace):
        pid = os.fork()
        if pid == 0:
            record = logging.makeLogRecord({"msg": "from the child"})
            os.write(writing, JsonFormatter("work_horse").format(record).encode())
            os._exit(0)
    os.waitpid(pid, 0)
    os.close(writing)
    with open(reading, "rb") as pipe:
        document = json.loads(pipe.read())
    assert (document["job_id"], document["trace_id"]) == ("c" * 32, trace.trace_id)
    assert document["process"] == "work_horse"


def test_a_json_line_is_one_line_whatever_is_logged() -> None:
    with logging_as(JsonFormatter("service")) as lines:
        log.error('a "name"\n{"level": "info"} \ud800 %s', object(), extra={"fields": {"status": 500, "odd": {1, 2}}})
        try:
            raise ValueError("a\nb")
        except ValueError:
            log.exception("failed")
    assert all("\n" not in line for line in lines)
    first, second = (json.loads(line) for line in lines)
    assert (first["level"], first["process"], first["status"]) == ("error", "service", 500)
    assert "ValueError" in second["exception"]


def test_without_a_context_there_is_no_trace(trace: Trace) -> None:
    assert current_traceparent() is None
    with about(trace=trace):
        assert current_traceparent() == trace.traceparent()
