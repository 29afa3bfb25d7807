"""Errors of the API as problem details (RFC 9457), with a stable ``code`` for programs."""

import json
import logging
from collections.abc import Mapping
from datetime import datetime
from http import HTTPStatus
from typing import Any

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from pydantic import BaseModel, Field
from pydantic.config import JsonDict
from pydantic.json_schema import SkipJsonSchema
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect
from starlette.responses import Response

from segcore.errors import InvalidParameters, MissingPackage, PartLocked
from worker.jobs.attempts import FAILURE_CODES
from worker.jobs.objects.durable import is_disk_full
from worker.jobs.objects.interface import StoreError
from worker.jobs.queue.connection import QueueError
from worker.jobs.store.revisions import RevisionDamaged, UnknownRevision
from worker.jobs.store.store import UnknownJob

log = logging.getLogger("cleave.service")

MEDIA_TYPE = "application/problem+json"

# Status of each code, and the sentence that says what it means and what to do.
_CODES: dict[str, tuple[int, str]] = {
    "malformed_request": (400, "The request cannot be read: send it again, well-formed and complete."),
    "unauthorized": (401, "This installation requires an API key: send it in the header Authorization: Bearer KEY."),
    "foreign_site": (
        403,
        "The request comes from a page of another site: the operator can allow that site in CLEAVE_CORS_ORIGINS.",
    ),
    "not_found": (404, "There is nothing at this path: GET /openapi.json lists all paths."),
    "job_not_found": (404, "There is no job with this id, or it belongs to another API key."),
    "batch_not_found": (404, "There is no batch with this id, or it belongs to another API key."),
    "method_not_allowed": (405, "This path does not support this method: see the Allow header."),
    "not_acceptable": (406, "Labels are not available in this format: accept another one, or use ?format=."),
    "revision_not_found": (404, "The job has no revision of this number: GET its revisions lists them."),
    "edit_not_found": (404, "The job has no edit of this id in the queue: edits within a request have none."),
    "too_slow": (408, "The upload stalled or is too slow: send it again over a better connection."),
    "not_finished": (409, "There is no result yet: poll the job until its status is succeeded."),
    "already_finished": (409, "The job has ended: delete it to remove its files."),
    "job_failed": (409, "The job failed and has no result; error contains the reason."),
    "job_canceled": (409, "The job was canceled and has no result: submit the mesh again."),
    "idempotency_key_spent": (409, "The job of this Idempotency-Key was deleted: use another key."),
    "revision_conflict": (
        409,
        "Somebody has edited the job since the revision that is named as base: revision is the newest one.",
    ),
    "part_locked": (409, "The edit would change a part that is locked: unlock it first."),
    "job_deleted": (410, "This job was deleted with its files: submit the mesh again."),
    "input_lost": (410, "The store no longer has the file that was sent: submit it again."),
    "revision_damaged": (410, "The store has lost this revision: restore an earlier one."),
    "length_required": (411, "The request has no body: send the mesh, with its Content-Length or in chunks."),
    "precondition_failed": (412, "The labels have changed since the ETag in If-Match: revision is the newest one."),
    "too_large": (413, "The mesh, the batch or a field is larger than this installation accepts."),
    "unsupported_media_type": (415, "The format of the body is not supported: see GET /v1/formats."),
    "range_not_satisfiable": (416, "The range lies outside the result."),
    "invalid_mesh": (422, "The mesh file is empty: send one with faces."),
    "invalid_file_set": (422, "The files are not one mesh with the files that belong to it; detail names them."),
    "input_changed": (
        422,
        "The file is read in another way than when it was segmented: submit it again.",
    ),
    "invalid_parameters": (422, "A parameter is out of range: see GET /v1/methods."),
    "invalid_request": (422, "A value in the path, the query or a header is not valid; detail names it."),
    "idempotency_key_reused": (
        422,
        "This Idempotency-Key was sent with another mesh, other parameters or another edit: use a new key.",
    ),
    "queue_full": (429, "Too many jobs are waiting: submit again after Retry-After."),
    "too_many_jobs": (429, "The caller has too many unfinished jobs: submit again when some have ended."),
    "too_many_bytes": (429, "The caller has uploaded too many bytes in this hour: continue after Retry-After."),
    "internal_error": (500, "The server failed with an internal error: its log has the details."),
    "missing_package": (
        501,
        "This installation lacks an optional package: its operator can install the one that detail names.",
    ),
    "queue_unavailable": (503, "The queue does not answer: try again after Retry-After."),
    "store_unavailable": (503, "The store does not answer: try again after Retry-After."),
    "guide_not_ready": (
        503,
        "The mesh is being prepared for its first preview: send the edit again after Retry-After.",
    ),
    "preview_too_slow": (
        503,
        "The preview takes more time or memory than a request may: send the edit itself, which may wait in the queue.",
    ),
    "insufficient_storage": (507, "The disk of the server is full: try again later or inform the operator."),
}
STATUS = {code: status for code, (status, _) in _CODES.items()}
MEANING = {code: sentence for code, (_, sentence) in _CODES.items()}
# Of the header Retry-After; set by hand.
_RETRY_AFTER_S = {
    "not_finished": 1,
    "guide_not_ready": 2,
    "preview_too_slow": 5,
    "queue_unavailable": 5,
    "store_unavailable": 5,
    "insufficient_storage": 60,
}


class JobError(BaseModel):
    """Why a job failed."""

    code: str = Field(
        description="Stable, for programs.", examples=["invalid_mesh"], json_schema_extra={"enum": list(FAILURE_CODES)}
    )
    message: str = Field(description="One sentence for people.")


def drop_default(schema: JsonDict) -> None:
    """Correct the schema of a field that is left out in place of its default."""
    del schema["default"]  # generators of types would take the field for one that is always there


class RevisionDocument(BaseModel):
    """A revision: the parts after an edit."""

    number: int = Field(examples=[3])
    parent: int = Field(description="The revision that was edited; 0 is the automatic result.", examples=[2])
    made_at: datetime
    made_by: str | None = Field(description="The name of the API key of the request; null if there was none.")
    what: str = Field(description="The operations, in words.", examples=["merge parts 1, 4"])
    segments: int = Field(description="The number of its parts.", examples=[7])


class ProblemDocument(BaseModel):
    """Problem details as in RFC 9457."""

    type: str = Field(examples=["about:blank"])
    title: str = Field(description="The phrase of the HTTP status.", examples=["Not Found"])
    status: int = Field(examples=[404])
    detail: str = Field(description="One sentence that says what to do.")
    code: str = Field(description="Stable, for programs.", json_schema_extra={"enum": list(STATUS)})
    error: JobError | SkipJsonSchema[None] = Field(
        default=None,
        description="With code job_failed: why the job failed. Otherwise absent.",
        json_schema_extra=drop_default,
    )
    revision: RevisionDocument | SkipJsonSchema[None] = Field(
        default=None,
        description="With code revision_conflict or precondition_failed: the newest revision. Otherwise absent.",
        json_schema_extra=drop_default,
    )


class Problem(Exception):  # noqa: N818
    """An error response. ``code`` is a key of STATUS; ``detail`` is the sentence of MEANING by default."""

    def __init__(
        self,
        code: str,
        detail: str | None = None,
        error: JobError | None = None,
        revision: RevisionDocument | None = None,
        headers: Mapping[str, str] | None = None,
    ) -> None:
        self.code = code
        self.detail = MEANING[code] if detail is None else detail
        self.error = error
        self.revision = revision
        self.headers = headers or {}
        super().__init__(self.detail)

    def response(self, headers: Mapping[str, str] | None = None) -> Response:
        """Return the response, with additional headers."""
        status = STATUS[self.code]
        document = _document(self.code, self.detail)
        if self.error is not None:
            document["error"] = self.error.model_dump()
        if self.revision is not None:
            document["revision"] = self.revision.model_dump(mode="json")
        own = {"Retry-After": str(_RETRY_AFTER_S[self.code])} if self.code in _RETRY_AFTER_S else {}
        if self.code == "unauthorized":
            own["WWW-Authenticate"] = "Bearer"
        # ASCII only, because a detail may quote a lone surrogate that a client sent.
        body = json.dumps(document, ensure_ascii=True, allow_nan=False)
        return Response(body, status, {**own, **self.headers, **(headers or {})}, MEDIA_TYPE)


def translate(exception: Exception) -> Problem:
    """Return the problem for an exception: the only place that maps exceptions to HTTP errors."""
    match exception:
        case Problem():
            return exception
        case UnknownJob():
            return Problem("job_not_found", "There is no job with this id: it was deleted, or the id is wrong.")
        case UnknownRevision():
            return Problem("revision_not_found")
        case RevisionDamaged():
            return Problem("revision_damaged")
        case PartLocked():
            return Problem("part_locked", str(exception))
        case MissingPackage():
            return Problem("missing_package", str(exception))
        case InvalidParameters():
            return Problem("invalid_parameters", str(exception))
        case RequestValidationError():
            return _invalid_request(exception)
        case HTTPException(status_code=404):
            return Problem("not_found")
        case HTTPException(status_code=405):
            return Problem("method_not_allowed")
        case ClientDisconnect() | HTTPException():
            return Problem("malformed_request")
        case QueueError():
            return Problem("queue_unavailable")
        case OSError() if is_disk_full(exception):
            return Problem("insufficient_storage")
        case StoreError():
            log.warning("%s", exception)
            return Problem("store_unavailable")
    log.error("a request failed with an unexpected exception", exc_info=exception)
    return Problem("internal_error")


def handle_problems(app: FastAPI) -> None:
    """Register handlers that answer every exception of an application with a problem."""

    def answer(request: Request, exception: Exception) -> Response:
        if isinstance(exception, OSError):
            request.app.state.context.metrics.store_failed()
        return translate(exception).response(getattr(exception, "headers", None))

    kinds: tuple[type[Exception], ...] = (
        Problem,
        UnknownJob,
        UnknownRevision,
        RevisionDamaged,
        PartLocked,
        MissingPackage,
        InvalidParameters,
        RequestValidationError,
        HTTPException,
        ClientDisconnect,
        QueueError,
        OSError,
        Exception,
    )
    for kind in kinds:
        app.add_exception_handler(kind, answer)


def documented(*codes: str) -> dict[int | str, dict[str, Any]]:
    """Return the ``responses`` of a route that may answer with these problems, for the OpenAPI document."""
    grouped: dict[int | str, dict[str, Any]] = {}
    for code in codes:
        status = STATUS[code]
        entry = grouped.setdefault(status, _described(status))
        entry["description"] += f" `{code}`"
        entry["content"][MEDIA_TYPE]["examples"][code] = {"value": example(code)}
        if code in _RETRY_AFTER_S or status == 429:
            entry["headers"] = {"Retry-After": {"schema": {"type": "integer"}, "description": "Seconds."}}
    return grouped


def example(code: str) -> dict[str, Any]:
    """Return an example of a problem document."""
    document = _document(code, MEANING[code])
    if code == "job_failed":
        document["error"] = {"code": "invalid_mesh", "message": "Face 3 refers to a vertex outside 0..7: [0, 1, 9]."}
    return document


def _document(code: str, detail: str) -> dict[str, Any]:
    status = STATUS[code]
    return {"type": "about:blank", "title": _phrase(status), "status": status, "detail": detail, "code": code}


def _described(status: int) -> dict[str, Any]:
    schema = {"$ref": "#/components/schemas/ProblemDocument"}
    return {"description": _phrase(status) + ":", "content": {MEDIA_TYPE: {"schema": schema, "examples": {}}}}


def _phrase(status: int) -> str:
    """Return the reason phrase of RFC 9110; those of Python differ between versions."""
    return {413: "Content Too Large", 416: "Range Not Satisfiable", 422: "Unprocessable Content"}.get(
        status
    ) or HTTPStatus(status).phrase


def _invalid_request(exception: RequestValidationError) -> Problem:
    first = exception.errors()[0]
    place, *path = (str(part) for part in first["loc"])
    return Problem("invalid_request", f"{' '.join(path)} in the {place} is not valid: {first['msg']}.")
