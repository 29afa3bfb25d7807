"""What the OpenAPI document says about submitting."""

from typing import Annotated, Any

from fastapi import Query

from segcore.io import FORMATS
from service.documents import JobDocument, SubmittedJobDocument
from service.openapi.document import PARAMETERS
from service.submit.form import MAX_PARAMETERS_BYTES
from service.submit.request import FORM_TYPE

SUBMISSION_PROBLEMS = (
    "malformed_request",
    "unauthorized",
    "foreign_site",
    "too_slow",
    "length_required",
    "too_large",
    "unsupported_media_type",
    "invalid_mesh",
    "invalid_parameters",
    "invalid_request",
    "queue_full",
    "too_many_jobs",
    "too_many_bytes",
    "queue_unavailable",
    "insufficient_storage",
)
MESH_SCHEMA = {"type": "string", "format": "binary", "minLength": 1, "description": "The bytes of a mesh file."}
_MESH = {"schema": MESH_SCHEMA}
_FORM = {
    "schema": {
        "type": "object",
        "required": ["mesh"],
        "additionalProperties": False,
        "properties": {
            "mesh": MESH_SCHEMA,
            "parameters": PARAMETERS,
        },
    },
    "encoding": {"parameters": {"contentType": "application/json"}},
}
PARAMETERS_IN_QUERY = {
    "name": "parameters",
    "in": "query",
    "description": "The parameters, where the body is not a form.",
    "content": {"application/json": {"schema": PARAMETERS, "example": {"max_segments": 32}}},
}
ParametersInQuery = Annotated[str | None, Query(max_length=MAX_PARAMETERS_BYTES, include_in_schema=False)]
Webhook = Annotated[
    str | None,
    Query(
        max_length=2000,
        description="The URL that is told when the job has ended, as in Standard Webhooks.",
        json_schema_extra={"pattern": r"^https?://[A-Za-z0-9.-]+(:[0-9]{1,4})?(/[!-~]*)?$"},
        examples=["https://example.com/hook"],
    ),
]
BODY: dict[str, Any] = {
    "parameters": [PARAMETERS_IN_QUERY],
    "requestBody": {
        "required": True,
        "description": "The mesh file as it is, also compressed with gzip, or in a form.",
        "content": {
            **{form.media_types[0]: _MESH for form in FORMATS.values()},
            "application/octet-stream": _MESH,
            FORM_TYPE: _FORM,
        },
    },
}
_JOB_HEADERS: dict[str, Any] = {
    "Location": {"schema": {"type": "string"}, "description": "The path of the job."},
    "RateLimit": {"schema": {"type": "string"}, "description": "What is left of the caller's limits."},
    "RateLimit-Policy": {"schema": {"type": "string"}, "description": "The caller's limits."},
    "Preference-Applied": {"schema": {"type": "string"}, "description": "The part of Prefer that was followed."},
}
_FOLLOWERS = (
    "get_job",
    "get_events",
    "get_labels",
    "get_hierarchy",
    "get_glb",
    "get_preview",
    "cancel_job",
    "delete_job",
)
_LINKS = {
    name: {"operationId": name, "parameters": {"job_id": "$response.body#/id"}, "description": "Of this job."}
    for name in _FOLLOWERS
}
ANSWERS: dict[int | str, dict[str, Any]] = {
    200: {
        "model": SubmittedJobDocument,
        "description": "The job has ended: within the time of Prefer: wait, or before, with the same mesh and "
        "parameters.",
        "headers": _JOB_HEADERS,
        "links": _LINKS,
    },
    202: {
        "model": JobDocument,
        "description": "The job is accepted and durable. Poll its Location, or listen to its events.",
        "headers": {**_JOB_HEADERS, "Retry-After": {"schema": {"type": "integer"}, "description": "Seconds."}},
        "links": _LINKS,
    },
}
