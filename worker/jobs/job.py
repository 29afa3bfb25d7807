"""What a job is, and the ways in which one ends, as values."""

import re
import secrets
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import Field

Cause: TypeAlias = Literal["worker_lost", "out_of_memory", "timed_out", "file_too_large", "internal_error"]

_JOB_ID = re.compile(r"[0-9a-f]{32}", re.ASCII)


@dataclass(frozen=True, slots=True, kw_only=True)
class Job:
    """A mesh that somebody wants segmented."""

    id: str  # 128 random bits in hexadecimal: who knows it may read the job
    sha256: str  # of the mesh file, in hexadecimal
    size_bytes: int  # of the mesh file
    mesh_format: str | None  # what the client's file name says, a hint; None: told from the bytes alone
    parameters: dict[str, Any]  # every field of SegmentationParameters
    created_at: datetime  # UTC
    file_name: str | None = None  # what the client calls the file: a label for people, never a path
    owner: str | None = None  # the name of the API key that it was submitted with; None: without one
    version: str | None = None  # of the software that accepted it
    webhook_url: str | None = None  # who is told that it has ended
    traceparent: str | None = None  # of the request that brought it, as in W3C Trace Context


@dataclass(frozen=True, slots=True, kw_only=True)
class Attempt:
    """One run of a job by a worker."""

    number: int  # 1, 2, ...
    worker: str
    started_at: datetime  # UTC
    ended_at: datetime | None = None  # None while it runs, and for ever where the worker died with it
    cause: Cause | None = None  # why it ended without an outcome


@dataclass(frozen=True, slots=True, kw_only=True)
class Succeeded:
    """The result file is in the store."""

    status: Literal["succeeded"] = "succeeded"
    finished_at: datetime
    faces: int
    vertices: int
    max_segments: int
    automatic_segments: int
    report: dict[str, Any] | None = None  # a MeshReport as values of JSON; None in records of earlier versions


@dataclass(frozen=True, slots=True, kw_only=True)
class Failed:
    """There is no result, and running the job again would not change that."""

    status: Literal["failed"] = "failed"
    finished_at: datetime
    code: str  # for programs
    message: str  # one sentence for people


@dataclass(frozen=True, slots=True, kw_only=True)
class Canceled:
    """The client no longer wants the result."""

    status: Literal["canceled"] = "canceled"
    finished_at: datetime


Outcome: TypeAlias = Annotated[Succeeded | Failed | Canceled, Field(discriminator="status")]

FAILURES: dict[Cause, str] = {
    "worker_lost": "The worker died while it ran this job, {attempts} times in a row: simplify the mesh, or ask the "
    "operator to look into the log of the workers.",
    "out_of_memory": "The job needs more memory than this installation gives it: send a mesh of fewer faces.",
    "timed_out": "The job runs longer than this installation allows: send a mesh of fewer faces.",
    "file_too_large": "The job writes a larger file than this installation allows: send a mesh of fewer faces.",
    "internal_error": "The job stopped at an internal error, {attempts} times in a row: ask the operator to look into "
    "the log of the workers.",
}


def new_job_id() -> str:
    return secrets.token_hex(16)


def is_job_id(text: str) -> bool:
    return _JOB_ID.fullmatch(text) is not None


def now() -> datetime:
    return datetime.now(UTC)


def exhausted(attempts: list[Attempt], max_attempts: int) -> Failed | None:
    """The end of a job that has had all its attempts, named after the last one; None where it may run again."""
    if len(attempts) < max_attempts:
        return None
    code: Cause = attempts[-1].cause or "worker_lost"
    return Failed(finished_at=now(), code=code, message=FAILURES[code].format(attempts=len(attempts)))
