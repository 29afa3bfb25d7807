"""The query parameters and headers of submissions."""

from dataclasses import dataclass
from typing import Annotated

from fastapi import Depends, Header, Query

from segcore.errors import InvalidParameters
from segcore.io import FORMATS
from segcore.levels import Fineness
from service.answer.level import Granularity
from service.submit.form import MAX_PARAMETERS_BYTES, Form
from service.submit.intake import JobRequest
from service.submit.request import requested_parameters

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
    parameters: ParametersInQuery = None
    segments: Annotated[
        int | None, Query(ge=1, description="The number of segments of the labels in the response.")
    ] = None
    granularity: Granularity = None
    file_name: Annotated[str | None, Query(max_length=1000, description="The name of the mesh.")] = None
    webhook: Webhook = None
    prefer: Annotated[str | None, Header(description="wait=N: respond when the job has ended, or after N seconds.")] = (
        None
    )
    idempotency_key: Annotated[
        str | None,
        Header(
            min_length=1,
            max_length=255,
            description="Any text that is unique per job: a repeated request with it creates no second job.",
        ),
    ] = None
    cache_control: Annotated[str | None, Header(description="no-cache: compute the result again.")] = None

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
            If the parameters are not valid, or the level does not exist with them.
        """
        parameters = requested_parameters(form.parameters, self.parameters)
        if self.segments is not None and self.segments > parameters.segment_limit:
            raise InvalidParameters(f"segments must be at most max_segments = {parameters.segment_limit}.")
        return JobRequest(
            parameters=parameters,
            mesh_format=mesh_format,
            file_name=self.file_name,
            webhook_url=self.webhook,
            idempotency_key=self.idempotency_key,
            may_reuse="no-cache" not in (self.cache_control or "").lower(),
        )


@dataclass(frozen=True, slots=True)
class BatchOptions:
    """The options of a batch, the same for all of its jobs."""

    parameters: ParametersInQuery = None
    webhook: Webhook = None

    def job_request(self, form: Form) -> JobRequest:
        """Return the request for a job with these options and the parameters of a form.

        Raises
        ------
        InvalidParameters
            If the parameters are not valid.
        """
        return JobRequest(parameters=requested_parameters(form.parameters, self.parameters), webhook_url=self.webhook)


JobOptionsOf = Annotated[JobOptions, Depends()]
BatchOptionsOf = Annotated[BatchOptions, Depends()]
