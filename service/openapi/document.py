"""Completion of the OpenAPI document of FastAPI with models and errors that the routes do not declare."""

from copy import deepcopy
from typing import Any

from fastapi import FastAPI
from pydantic import BaseModel
from pydantic.json_schema import models_json_schema

from segcore.parameters import parameters_schema
from service.answer.part_list import PartsDocument
from service.answer.renditions import PARTIAL_CONTENT
from service.documents import BatchJobs, HierarchyDocument, LabelsDocument, RunsDocument
from service.edit.label_uploads import UploadedLabels, UploadedRuns
from service.openapi.exactness import make_exact
from service.openapi.examples import add_examples
from service.printing.documents import PrintDocument
from service.problems import MEDIA_TYPE, ProblemDocument, documented
from service.robots.documents import RobotDocument
from worker.edits.operation_documents import EditDocument

# Models of requests and responses that the routes handle as bytes, so that FastAPI does not find them.
_HIDDEN_MODELS: tuple[type[BaseModel], ...] = (
    ProblemDocument,
    LabelsDocument,
    RunsDocument,
    HierarchyDocument,
    PartsDocument,
    BatchJobs,
    EditDocument,
    PrintDocument,
    RobotDocument,
    UploadedLabels,
    UploadedRuns,
)
_PLACE = "#/components/schemas/{model}"
_STORE_PATHS = ("/v1/jobs", "/v1/batches")  # the operations below them need the store
_UNUSED = ("HTTPValidationError", "ValidationError")

PARAMETERS = {"$ref": _PLACE.format(model="Parameters")}

_ABOUT = """\
Submit a mesh, poll the job or read its events, and get labels, the hierarchy of parts, and coloured models at any
number of segments. Labels are per face, in the order of the file: face *i* is the *i*-th triangle after polygons are
split into triangles.

Every error is `application/problem+json` (RFC 9457): a stable `code` for programs and a `detail` that says what to do.
"""


def ref(model: type[BaseModel]) -> dict[str, str]:
    """Return a reference to the schema of a model."""
    return {"$ref": _PLACE.format(model=model.__name__)}


def complete(app: FastAPI, *, keys_required: bool) -> None:
    """Let an application serve the completed document."""
    app.description = _ABOUT
    original = app.openapi

    def document() -> dict[str, Any]:
        if app.openapi_schema is None:
            app.openapi_schema = _completed(original(), keys_required)
        return app.openapi_schema

    app.openapi = document  # type: ignore[method-assign]


def _completed(document: dict[str, Any], keys_required: bool) -> dict[str, Any]:
    schemas = document["components"]["schemas"]
    _, hidden = models_json_schema([(model, "serialization") for model in _HIDDEN_MODELS], ref_template=_PLACE)
    schemas.update(hidden["$defs"])
    schemas["Parameters"] = deepcopy(parameters_schema())
    document["components"]["responses"] = {"PartialContent": PARTIAL_CONTENT}
    for name in _UNUSED:
        schemas.pop(name, None)
    for path, operations in document["paths"].items():
        for operation in operations.values():
            _correct(operation, keys_required)
            _add_problem(operation, "malformed_request")
            if path.startswith("/v1/"):
                _add_problem(operation, "invalid_request")
            if path.startswith(_STORE_PATHS):
                _add_problem(operation, "store_unavailable")
    make_exact(document)
    add_examples(document)
    if not keys_required:
        document["components"].pop("securitySchemes", None)
    return document


def _correct(operation: dict[str, Any], keys_required: bool) -> None:
    """Remove the validation errors of FastAPI, and the API key if none is required."""
    responses = operation["responses"]
    for status, response in list(responses.items()):
        schema = response.get("content", {}).get("application/json", {}).get("schema", {}).get("$ref", "")
        if schema.endswith("/HTTPValidationError"):
            del responses[status]
    if not keys_required:
        operation.pop("security", None)


def _add_problem(operation: dict[str, Any], code: str) -> None:
    """Add a problem to the responses of an operation, besides other problems with the same status."""
    for status, response in documented(code).items():
        existing = operation["responses"].setdefault(str(status), response)
        if existing is not response and code not in existing["content"][MEDIA_TYPE]["examples"]:
            existing["description"] += f" `{code}`"
            existing["content"][MEDIA_TYPE]["examples"] |= response["content"][MEDIA_TYPE]["examples"]
