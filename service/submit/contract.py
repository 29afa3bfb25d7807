"""The OpenAPI description of submissions: bodies, shared parameters, responses and errors."""

from typing import Any

from segcore.io import FORMATS
from service.answer.archive import ZIP
from service.documents import BatchDocument, BatchJobs
from service.job_documents import SubmittedJobDocument, UnfinishedJobDocument
from service.openapi.document import PARAMETERS, ref
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
    "invalid_file_set",
    "invalid_parameters",
    "invalid_request",
    "queue_full",
    "too_many_jobs",
    "too_many_bytes",
    "queue_unavailable",
    "insufficient_storage",
)
JSON = "application/json"
_MESH = {"type": "string", "format": "binary", "minLength": 1, "description": "The bytes of a mesh file."}
_PARAMETERS_IN_QUERY = {
    "name": "parameters",
    "in": "query",
    "description": "The parameters, if the body is not a form.",
    "content": {JSON: {"schema": PARAMETERS, "example": {"max_segments": 32}}},
}


_FILES = {"type": "array", "minItems": 1, "items": _MESH}


def _form(mesh: dict[str, Any]) -> dict[str, Any]:
    return {
        "schema": {
            "type": "object",
            "required": ["mesh"],
            "additionalProperties": False,
            "properties": {"mesh": mesh, "parameters": PARAMETERS},
        },
        "encoding": {"parameters": {"contentType": JSON}},
    }


JOB_BODY: dict[str, Any] = {
    "parameters": [_PARAMETERS_IN_QUERY],
    "requestBody": {
        "required": True,
        "description": "The mesh file, optionally compressed with gzip, or a form that contains it. A ZIP archive, or "
        "the fields `mesh` of a form, may be one mesh and the files that it refers to, such as materials and pictures; "
        "the names of the fields are then their paths in the set.",
        "content": {
            **{form.media_types[0]: {"schema": _MESH} for form in FORMATS.values()},
            "application/zip": {"schema": _MESH},
            "application/octet-stream": {"schema": _MESH},
            FORM_TYPE: _form(_FILES),
        },
    },
}
RERUN_BODY: dict[str, Any] = {
    "requestBody": {
        "required": False,
        "description": "The parameters; those that are missing have their defaults.",
        "content": {JSON: {"schema": PARAMETERS, "example": {"structure": "shells"}}},
    },
}
BATCH_BODY: dict[str, Any] = {
    "parameters": [_PARAMETERS_IN_QUERY],
    "requestBody": {
        "required": True,
        "description": "Mesh files, in a form or a ZIP archive. Other files belong to the meshes that refer to "
        "them; `left_out` in the response lists the others.",
        "content": {
            FORM_TYPE: _form(_FILES),
            ZIP: {"schema": {"type": "string", "format": "binary", "description": "A ZIP archive of mesh files."}},
            JSON: {"schema": ref(BatchJobs)},
        },
    },
}
_JOB_HEADERS: dict[str, Any] = {
    "Location": {"schema": {"type": "string"}, "description": "The path of the job."},
    "RateLimit": {"schema": {"type": "string"}, "description": "The remaining limits of the caller."},
    "RateLimit-Policy": {"schema": {"type": "string"}, "description": "The limits of the caller."},
    "Preference-Applied": {"schema": {"type": "string"}, "description": "The preference that was applied."},
}
_JOB_OPERATIONS = (
    "get_job",
    "get_events",
    "get_labels",
    "get_hierarchy",
    "get_glb",
    "get_preview",
    "create_edit",
    "put_labels",
    "list_revisions",
    "cancel_job",
    "rerun_job",
    "delete_job",
)
_LINKS = {
    name: {"operationId": name, "parameters": {"job_id": "$response.body#/id"}, "description": "Of this job."}
    for name in _JOB_OPERATIONS
}
JOB_RESPONSES: dict[int | str, dict[str, Any]] = {
    200: {
        "model": SubmittedJobDocument,
        "description": "The job has ended: within the time of Prefer: wait, or at once, if it shares the result of an "
        "earlier job of the caller with the same mesh and parameters.",
        "headers": _JOB_HEADERS,
        "links": _LINKS,
    },
    202: {
        "model": UnfinishedJobDocument,
        "description": "The job is accepted and stored. Poll its Location, or read its events.",
        "headers": {**_JOB_HEADERS, "Retry-After": {"schema": {"type": "integer"}, "description": "Seconds."}},
        "links": _LINKS,
    },
}
BATCH_RESPONSES: dict[int | str, dict[str, Any]] = {
    202: {
        "model": BatchDocument,
        "description": "All jobs of the batch are accepted.",
        "headers": {"Location": {"schema": {"type": "string"}, "description": "The path of the batch."}},
        "links": {
            name: {"operationId": name, "parameters": {"batch_id": "$response.body#/id"}}
            for name in ("get_batch", "get_batch_results", "delete_batch")
        },
    }
}
