"""Logging of the processes of Cleave to the standard error, as text or as JSON objects.

Every line that is logged inside the context ``about`` contains the job and the trace, also lines of libraries and of a
child process that is forked in the context.
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

_FIELDS = "fields"  # the key of further fields in logging's ``extra``: {"fields": {...}}


@dataclass(slots=True)
class Subject:
    """The job and the trace of log lines; the job of a request is set once it is known."""

    job_id: str | None = None
    trace: Trace | None = None


_SUBJECT: ContextVar[Subject | None] = ContextVar("cleave_log_subject", default=None)


@contextmanager
def about(job_id: str | None = None, trace: Trace | str | None = None) -> Iterator[Subject]:
    """Add a job and a trace, or its ``traceparent``, to every line that is logged in this context."""
    subject = Subject(job_id, parse_traceparent(trace) if isinstance(trace, str) else trace)
    token = _SUBJECT.set(subject)
    try:
        yield subject
    finally:
        _SUBJECT.reset(token)


def note_job(job_id: str) -> None:
    """Set the job of the current context ``about``, if there is one."""
    subject = _SUBJECT.get()
    if subject is not None:
        subject.job_id = job_id


def current_traceparent() -> str | None:
    """Return the trace of the current context as a ``traceparent``; None if there is none."""
    subject = _SUBJECT.get()
    return subject.trace.traceparent() if subject and subject.trace else None


def configure_logging(level: str, log_format: LogFormat = "auto", process: str = "cleave") -> None:
    """Configure logging to the standard error; the format ``auto`` is text on a terminal and JSON elsewhere."""
    is_text = log_format == "text" or (log_format == "auto" and sys.stderr.isatty())
    handler = logging.StreamHandler()
    handler.setFormatter(TextFormatter() if is_text else JsonFormatter(process))
    logging.basicConfig(level=level.upper(), handlers=[handler])


def rename_process(process: str) -> None:
    """Change the process name in the log, after a fork."""
    for handler in logging.getLogger().handlers:
        if isinstance(handler.formatter, JsonFormatter):
            handler.formatter.process = process


class TextFormatter(logging.Formatter):
    """Text lines: time, level, logger and message, then job, trace and other fields in brackets."""

    def __init__(self) -> None:
        super().__init__("%(asctime)s %(levelname)-7s %(name)s: %(message)s")

    def formatMessage(self, record: logging.LogRecord) -> str:  # noqa: N802  # logging's name
        notes = " ".join(f"{name}={value}" for name, value in {**_subject(), **_fields(record)}.items())
        return super().formatMessage(record) + (f" [{notes}]" if notes else "")


class JsonFormatter(logging.Formatter):
    """One JSON object per line, with line breaks in messages escaped."""

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
