"""The query parameters and headers of submissions."""

import inspect
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from typing import Annotated, Any, TypeVar, get_args

from fastapi import Depends, Header, Query

from segcore.coordinates import Axis, Unit, axis_named, unit_named
from segcore.errors import InvalidParameters
from segcore.io import FORMATS
from segcore.levels import Fineness
from service.answer.level import Granularity
from service.submit.form import MAX_PARAMETERS_BYTES, Form
from service.submit.intake import JobRequest
from service.submit.request import requested_parameters

Options = TypeVar("Options")

ParametersInQuery = Annotated[str | None, Query(max_length=MAX_PARAMETERS_BYTES, include_in_schema=False)]
Webhook = Annotated[
    str | None,
    Query(
        max_length=2000,
        description="The URL that receives a message when the job has ended, as in Standard Webhooks.",
        json_schema_extra={"pattern": r"^https?://[A-Za-z0-9.-]+(:[0-9]{1,4})?(/[!-~]*)?$"},
        examples=["https://example.com/hook"],
    ),
]
UnitOfMesh = Annotated[
    str | None,
    Query(
        max_length=40,
        description="The unit of the coordinates, if the mesh does not name it: for example mm. Results that name a "
        "unit are converted.",
        json_schema_extra={"enum": list(get_args(Unit))},
        examples=["millimeter"],
    ),
]
UpOfMesh = Annotated[
    str | None,
    Query(
        max_length=40,
        description="The axis that points up, y or z, if the mesh does not name it.",
        json_schema_extra={"enum": list(get_args(Axis))},
        examples=["z"],
    ),
]
Prefer = Annotated[str | None, Header(description="wait=N: respond when the job has ended, or after N seconds.")]
IdempotencyKey = Annotated[
    str | None,
    Header(
        min_length=1,
        max_length=255,
        description="Any text that is unique per job: a repeated request with it creates no second job.",
    ),
]
CacheControl = Annotated[str | None, Header(description="no-cache: compute the result again.")]


@dataclass(frozen=True, slots=True)
class JobOptions:
    """The options of a job."""

    format: Annotated[
        str | None,
        Query(
            max_length=100,
            description="The format of the mesh, if neither its name nor its type declares it.",
            json_schema_extra={"enum": list(FORMATS)},
            examples=["stl"],
        ),
    ] = None
    unit: UnitOfMesh = None
    up: UpOfMesh = None
    parameters: ParametersInQuery = None
    segments: Annotated[
        int | None, Query(ge=1, description="The number of segments of the labels in the response.")
    ] = None
    granularity: Granularity = None
    file_name: Annotated[str | None, Query(max_length=1000, description="The name of the mesh.")] = None
    webhook: Webhook = None
    prefer: Prefer = None
    idempotency_key: IdempotencyKey = None
    cache_control: CacheControl = None

    def fineness(self) -> Fineness:
        """Return the level of the labels in the response.

        Raises
        ------
        InvalidParameters
            If both segments and granularity are given.
        """
        return Fineness(self.segments, self.granularity)

    def job_request(self, form: Form, mesh_format: str | None) -> JobRequest:
        """Return the request for a job with these options and the parameters of a form.

        Raises
        ------
        InvalidParameters
            If the parameters, the unit or the axis are not valid, or the level does not exist with them.
        """
        parameters = requested_parameters(form.parameters, self.parameters)
        if self.segments is not None and self.segments > parameters.segment_limit:
            raise InvalidParameters(f"segments must be at most max_segments = {parameters.segment_limit}.")
        return JobRequest(
            parameters=parameters,
            mesh_format=mesh_format,
            unit=None if self.unit is None else unit_named(self.unit),
            up=None if self.up is None else axis_named(self.up),
            file_name=self.file_name,
            webhook_url=self.webhook,
            idempotency_key=self.idempotency_key,
            may_reuse=may_reuse(self.cache_control),
        )


@dataclass(frozen=True, slots=True)
class RerunOptions:
    """The options of a job that has the mesh of an earlier one."""

    webhook: Webhook = None
    prefer: Prefer = None
    idempotency_key: IdempotencyKey = None
    cache_control: CacheControl = None


@dataclass(frozen=True, slots=True)
class BatchOptions:
    """The options of a batch, the same for all of its jobs."""

    unit: UnitOfMesh = None
    up: UpOfMesh = None
    parameters: ParametersInQuery = None
    webhook: Webhook = None

    def job_request(self, form: Form) -> JobRequest:
        """Return the request for a job with these options and the parameters of a form.

        Raises
        ------
        InvalidParameters
            If the parameters, the unit or the axis are not valid.
        """
        return JobRequest(
            parameters=requested_parameters(form.parameters, self.parameters),
            unit=None if self.unit is None else unit_named(self.unit),
            up=None if self.up is None else axis_named(self.up),
            webhook_url=self.webhook,
        )


def may_reuse(cache_control: str | None) -> bool:
    """Whether a request may share the result of an earlier job."""
    return "no-cache" not in (cache_control or "").lower()


def _in_event_loop(options: Callable[..., Options]) -> Callable[..., Awaitable[Options]]:
    """Return a dependency that makes options without the change of threads that FastAPI makes for a class."""

    async def make(**values: Any) -> Options:
        return options(**values)

    make.__signature__ = inspect.signature(options)  # type: ignore[attr-defined]
    return make


JobOptionsOf = Annotated[JobOptions, Depends(_in_event_loop(JobOptions))]
RerunOptionsOf = Annotated[RerunOptions, Depends(_in_event_loop(RerunOptions))]
BatchOptionsOf = Annotated[BatchOptions, Depends(_in_event_loop(BatchOptions))]
