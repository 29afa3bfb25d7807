"""A job and its possible outcomes."""

import re
import secrets
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import Field

_JOB_ID = re.compile(r"[0-9a-f]{32}", re.ASCII)


@dataclass(frozen=True, slots=True, kw_only=True)
class Job:
    """A mesh to be segmented."""

    id: str  # 128 random bits in hexadecimal, which nobody can guess
    sha256: str  # of the mesh file, in hexadecimal
    size_bytes: int  # of the mesh file
    mesh_format: str | None  # a hint from the client or its file name; None: detected from the bytes alone
    unit: str | None = None  # of the coordinates, as the client says; None: as the file has it
    up: str | None = None  # the axis that points up, in the same way
    parameters: dict[str, Any]  # every field of SegmentationParameters
    created_at: datetime  # UTC
    file_name: str | None = None  # the client's name of the file, for display; never used as a path
    owner: str | None = None  # the name of the API key of the request; None if there was none
    version: str | None = None  # of the software that accepted the job
    webhook_url: str | None = None  # to which the end of the job is reported
    traceparent: str | None = None  # of the request, as in W3C Trace Context


@dataclass(frozen=True, slots=True, kw_only=True)
class Succeeded:
    """The job has a result file in the store."""

    status: Literal["succeeded"] = "succeeded"
    finished_at: datetime
    faces: int
    vertices: int
    max_segments: int
    automatic_segments: int
    limit_reached: bool | None = None  # as in Hierarchy; None in records of earlier versions
    report: dict[str, Any] | None = None  # a MeshReport as JSON; None in records of earlier versions


@dataclass(frozen=True, slots=True, kw_only=True)
class Failed:
    """The job has no result, and running it again would not change that."""

    status: Literal["failed"] = "failed"
    finished_at: datetime
    code: str  # stable, for programs
    message: str  # one sentence, for people


@dataclass(frozen=True, slots=True, kw_only=True)
class Canceled:
    """The client has canceled the job."""

    status: Literal["canceled"] = "canceled"
    finished_at: datetime


Outcome: TypeAlias = Annotated[Succeeded | Failed | Canceled, Field(discriminator="status")]


def new_job_id() -> str:
    return secrets.token_hex(16)


def is_job_id(text: str) -> bool:
    return _JOB_ID.fullmatch(text) is not None


def now() -> datetime:
    return datetime.now(UTC)
