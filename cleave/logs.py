"""How the processes of Cleave log: lines on the standard error, which the supervisor or the container keeps.

A line is text, or a JSON object for programs that collect logs. Either says which job and which trace it is about: what
is logged inside ``about`` carries both, also by libraries, and in a work-horse that is forked there.
"""

import json
import logging
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any, Literal, TypeAlias

from cleave.trace import Trace, parse_traceparent

LogFormat: TypeAlias = Literal["auto", "json", "text"]

_FIELDS = "fields"  # what callers give as logging's ``extra``: {"fields": {...}}


@dataclass(slots=True)
class Subject:
    """What the lines of a request or of a job are about; the job of a request is known only in its course."""

    job_id: str | None = None
    trace: Trace | None = None


_SUBJECT: ContextVar[Subject | None] = ContextVar("cleave_log_subject", default=None)


@contextmanager
def about(job_id: str | None = None, trace: Trace | str | None = None) -> Iterator[Subject]:
    """Have every line that is logged inside say what it is about; a trace may be given as its ``traceparent``."""
    subject = Subject(job_id, parse_traceparent(trace) if isinstance(trace, str) else trace)
    token = _SUBJECT.set(subject)
    try:
        yield subject
    finally:
        _SUBJECT.reset(token)


def note_job(job_id: str) -> None:
    """Say that the rest of what is logged here is about a job; without effect outside of ``about``."""
    subject = _SUBJECT.get()
    if subject is not None:
        subject.job_id = job_id


def current_traceparent() -> str | None:
    """The trace of what is going on here, in the form in which a job keeps it."""
    subject = _SUBJECT.get()
    return subject.trace.traceparent() if subject and subject.trace else None


def configure_logging(level: str, log_format: LogFormat = "auto", process: str = "cleave") -> None:
    """Log to the standard error; ``auto`` is text at a terminal and JSON elsewhere."""
    is_text = log_format == "text" or (log_format == "auto" and sys.stderr.isatty())
    handler = logging.StreamHandler()
    handler.setFormatter(TextFormatter() if is_text else JsonFormatter(process))
    logging.basicConfig(level=level.upper(), handlers=[handler])


def rename_process(process: str) -> None:
    """Log under another name, after a fork."""
    for handler in logging.getLogger().handlers:
        if isinstance(handler.formatter, JsonFormatter):
            handler.formatter.process = process


class TextFormatter(logging.Formatter):
    """For people: the time, the level, who says it, what, and in brackets what it is about."""

    def __init__(self) -> None:
        super().__init__("%(asctime)s %(levelname)-7s %(name)s: %(message)s")

    def formatMessage(self, record: logging.LogRecord) -> str:  # noqa: N802  # logging's name
        notes = " ".join(f"{name}={value}" for name, value in {**_subject(), **_fields(record)}.items())
        return super().formatMessage(record) + (f" [{notes}]" if notes else "")


class JsonFormatter(logging.Formatter):
    """For programs: one JSON object per line, whatever the message holds."""

    def __init__(self, process: str) -> None:
        super().__init__()
        self.process = process

    def format(self, record: logging.LogRecord) -> str:
        document: dict[str, Any] = {
            "time": datetime.fromtimestamp(record.created, UTC).isoformat(timespec="milliseconds"),
            "level": record.levelname.lower(),
            "process": self.process,
            "pid": record.process,
            "logger": record.name,
            "message": record.getMessage(),
            **_subject(),
            **_fields(record),
        }
        if record.exc_info:
            document["exception"] = self.formatException(record.exc_info)
        return json.dumps(document, default=str)


def _subject() -> dict[str, str]:
    subject = _SUBJECT.get()
    if subject is None:
        return {}
    known = {"job_id": subject.job_id, "trace_id": subject.trace.trace_id if subject.trace else None}
    return {name: value for name, value in known.items() if value is not None}


def _fields(record: logging.LogRecord) -> dict[str, Any]:
    return getattr(record, _FIELDS, None) or {}
