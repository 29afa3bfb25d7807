"""The settings of an installation, read from the environment at the start of a process."""

import difflib
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

from platformdirs import user_data_path
from pydantic import AfterValidator, Field, ValidationError
from pydantic_settings import BaseSettings, SettingsConfigDict

from cleave.logs import LogFormat

_PREFIX = "CLEAVE_"
_OTHER_VARIABLES = {"API_KEY"}  # of the command line, as a client
# Kubernetes sets these for every service, such as CLEAVE_SERVICE_HOST and CLEAVE_PORT_8000_TCP.
_OF_KUBERNETES = re.compile(r".*_(SERVICE_(HOST|PORT)(_.*)?|PORT(_\d+_(TCP|UDP|SCTP)(_.*)?)?)")
LONGEST_WAIT_S = 600.0  # upper limit of CLEAVE_MAX_WAIT_S; set by hand


class InvalidSettings(Exception):  # noqa: N818
    """An environment variable has an invalid value; the message names it."""


class Settings(BaseSettings):
    """The settings of an installation; the environment variable of each is CLEAVE_ and its name in capitals.

    By default a job of max_faces faces uses a third of job_memory_bytes (bench/RESULTS.md, "Throughput and memory").
    The other defaults are limits that were set by hand.
    """

    model_config = SettingsConfigDict(env_prefix=_PREFIX, env_ignore_empty=True, extra="ignore", frozen=True)

    data_dir: Annotated[Path, AfterValidator(lambda path: path.expanduser().absolute())] = Field(
        default_factory=lambda: user_data_path("cleave", appauthor=False),
        description="Folder of the jobs and their files; service and workers share it.",
    )
    store_url: str | None = Field(
        default=None,
        pattern=r"^(s3|gs|az)://",
        description="Bucket of the jobs, such as s3://bucket/prefix; if none is set, jobs are kept in the data folder.",
    )
    store_cache_bytes: int = Field(
        default=2**30, ge=0, description="Size of the cache of a bucket's results in the data folder of a service."
    )
    retention_s: float | None = Field(
        default=None, ge=0, description="Time after its end after which a job is deleted; never if none is set."
    )
    retention_bytes: int | None = Field(
        default=None,
        ge=0,
        description="Size of the meshes and results of all ended jobs above which those that ended first are deleted; "
        "no limit if none is set.",
    )
    redis_url: str | None = Field(
        default=None,
        pattern=r"^(redis|rediss|unix)://",
        description="Queue server, such as redis://host:6379/0; if none is set, `cleave serve` starts its own.",
    )
    auth: Literal["auto", "required", "off"] = Field(
        default="auto",
        description="Whether API keys are required; auto: if there are any, or if the address is not loopback.",
    )
    api_keys: str | None = Field(
        default=None, description="API keys, NAME:DIGEST separated by commas, as `cleave key NAME` prints them."
    )
    api_keys_file: Path | None = Field(
        default=None, description="File with one NAME:DIGEST per line; it is read again when it changes."
    )
    root_path: Annotated[str, AfterValidator(lambda path: path.rstrip("/"))] = Field(
        default="",
        pattern=r"^(/[A-Za-z0-9._~-]+)*/?$",
        description="Path below which a proxy shows the service, such as /cleave, if it sends no X-Forwarded-Prefix.",
    )
    cors_origins: str | None = Field(
        default=None, description="Origins whose pages may use the API, separated by commas; * for all."
    )
    key_max_queued_jobs: int = Field(default=1000, ge=1, description="Unfinished jobs that a key may have.")
    key_max_running_jobs: int | None = Field(
        default=None,
        ge=1,
        description="Jobs of a key that wait in the queue or run at a time; the others wait in the store.",
    )
    key_upload_bytes_per_hour: int | None = Field(
        default=None, ge=1, description="Bytes that a key may upload in an hour."
    )
    max_queued_jobs: int = Field(default=10_000, ge=1, description="Unfinished jobs that the installation may have.")
    max_wait_s: float = Field(
        default=60.0, ge=0, le=LONGEST_WAIT_S, description="Longest time for which a response is held back."
    )
    max_stream_s: float = Field(
        default=3600.0, gt=0, description="Longest stream of events; clients reconnect by themselves."
    )
    max_batch_jobs: int = Field(default=1000, ge=1, le=10_000, description="Most jobs in a batch.")
    webhook_private_targets: bool = Field(
        default=False, description="Whether webhooks may go to private, link-local and loopback addresses."
    )
    max_upload_bytes: int = Field(default=512 * 2**20, gt=0, description="Largest mesh file that is accepted.")
    max_batch_bytes: int = Field(default=4 * 2**30, gt=0, description="Largest batch, packed and unpacked.")
    upload_idle_s: float = Field(default=30.0, gt=0, description="Time without data after which an upload is ended.")
    upload_bytes_per_s: int = Field(
        default=1024, ge=0, description="Lowest average speed of an upload, after its first upload_idle_s."
    )
    max_uncompressed_bytes: int = Field(
        default=2 * 2**30, gt=0, description="Largest mesh file after decompression, if it is compressed."
    )
    max_faces: int = Field(default=5_000_000, gt=0, description="Largest number of faces that is segmented.")
    max_vertices: int = Field(
        default=15_000_000,
        gt=0,
        description="Largest number of vertices of a mesh; STL files have three for every face.",
    )
    large_job_bytes: int = Field(
        default=4 * 2**20,
        gt=0,
        description="Size of a mesh file from which on its job waits in the queue of the large jobs.",
    )
    max_attempts: int = Field(default=3, ge=1, description="Runs of a job whose worker dies every time.")
    job_timeout_s: float = Field(default=3600.0, gt=0, description="Longest run of a job.")
    job_cpu_s: int = Field(default=3600, gt=0, description="Longest processor time of a job.")
    job_threads: int | None = Field(
        default=None,
        ge=1,
        le=256,
        description="Threads of a job, which do not change its result; if none is set, one for a mesh of fewer than "
        "200,000 faces and the cores that are idle for others.",
    )
    job_memory_bytes: int = Field(default=8 * 2**30, gt=0, description="Address space of the process that runs a job.")
    job_file_bytes: int = Field(default=4 * 2**30, gt=0, description="Largest file that a job may write.")
    lease_s: float = Field(
        default=10.0,
        ge=3,
        le=30,
        description="A running job is run again if its worker sends no heartbeat for this long.",
    )
    janitor_interval_s: float = Field(
        default=2.0, gt=0, le=30, description="Pause between two searches for jobs that the queue has lost."
    )
    shutdown_grace_s: float = Field(
        default=3.0,
        ge=0,
        description="Time for which a running job may go on when its worker is stopped; then it is requeued.",
    )
    result_cache_bytes: int = Field(
        default=64 * 2**20, ge=0, description="Size of the service's cache of opened results, in memory."
    )
    rendered_cache_bytes: int = Field(
        default=64 * 2**20, ge=0, description="Size of its cache of pictures and models made of them, in memory."
    )
    edit_processes: int = Field(
        default=2, ge=1, le=64, description="Processes in which a service computes edits that look at the surface."
    )
    edit_cache_bytes: int = Field(
        default=2**30, ge=0, description="Size of the prepared meshes that each of these processes keeps in memory."
    )
    edit_memory_bytes: int = Field(
        default=4 * 2**30, gt=0, description="Address space of each of these processes; larger edits wait in the queue."
    )
    edit_timeout_s: float = Field(
        default=10.0,
        gt=0,
        description="Longest time for which a request waits for an edit; longer ones wait in the queue.",
    )
    log_level: str = Field(
        default="info", pattern=r"^(debug|info|warning|error)$", description="Lowest level that is logged."
    )
    log_format: LogFormat = Field(
        default="auto", description="Format of the log: text, json, or auto: text on a terminal, JSON elsewhere."
    )

    def allowed_origins(self) -> list[str]:
        """The entries of ``cors_origins`` as browsers send origins: in lower case, without a slash at the end."""
        entries = (entry.strip().rstrip("/").lower() for entry in (self.cors_origins or "").split(","))
        return [entry for entry in entries if entry]


def unknown_variables(environment: Mapping[str, str]) -> dict[str, str | None]:
    """Return the variables that begin with CLEAVE_ and are no settings, each with the nearest setting, if any."""
    known = {name.upper() for name in Settings.model_fields} | _OTHER_VARIABLES
    unknown: dict[str, str | None] = {}
    for variable in sorted(environment):
        prefix, name = variable[: len(_PREFIX)].upper(), variable[len(_PREFIX) :].upper()
        if prefix == _PREFIX and name not in known and not _OF_KUBERNETES.fullmatch(variable):
            near = difflib.get_close_matches(name, sorted(known), 1)
            unknown[variable] = f"{_PREFIX}{near[0]}" if near else None
    return unknown


def load_settings(**overrides: Any) -> Settings:
    """Read the settings from the environment; an override that is None has no effect.

    Raises
    ------
    InvalidSettings
        If a value is invalid.
    """
    try:
        return Settings(**{name: value for name, value in overrides.items() if value is not None})
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        name = "_".join(str(part) for part in first["loc"])
        raise InvalidSettings(f"CLEAVE_{name.upper()} is {first['input']!r}: {first['msg']}.") from error
