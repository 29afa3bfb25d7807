"""What a job is, and the ways in which one ends, as values."""

import re
import secrets
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import Field

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


def new_job_id() -> str:
    return secrets.token_hex(16)


def is_job_id(text: str) -> bool:
    return _JOB_ID.fullmatch(text) is not None


def now() -> datetime:
    return datetime.now(UTC)
