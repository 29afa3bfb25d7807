"""Every error body of the service: problem details as in RFC 9457, with a stable ``code`` for programs."""

import json
import logging
from collections.abc import Mapping
from http import HTTPStatus
from typing import Any

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from pydantic import BaseModel, Field
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect
from starlette.responses import Response

from segcore.errors import InvalidParameters
from worker.jobs.objects.durable import is_disk_full
from worker.jobs.objects.interface import StoreError
from worker.jobs.queue.connection import QueueError
from worker.jobs.store.store import UnknownJob

log = logging.getLogger("cleave.service")

MEDIA_TYPE = "application/problem+json"

# What each code stands for: its status, and what to do.
_CODES: dict[str, tuple[int, str]] = {
    "malformed_request": (400, "The request cannot be read: send it again, well-formed and whole."),
    "unauthorized": (401, "This installation requires an API key: send it in the header Authorization: Bearer KEY."),
    "foreign_site": (403, "A page of another site sent this: the operator can allow it in CLEAVE_CORS_ORIGINS."),
    "not_found": (404, "There is nothing at this path: GET /openapi.json lists what there is."),
    "job_not_found": (404, "There is no job of this id, or it is somebody else's."),
    "batch_not_found": (404, "There is no batch of this id, or it is somebody else's."),
    "method_not_allowed": (405, "This path does not take this method: see the Allow header."),
    "not_acceptable": (406, "Labels are not sent in that form: accept another, or ask with ?format=."),
    "too_slow": (408, "The upload came to a halt or is too slow: send it again over a better connection."),
    "not_finished": (409, "There is no result yet: poll the job until its status is succeeded."),
    "already_finished": (409, "The job has ended: delete it to remove its files."),
    "job_failed": (409, "The job failed and has no result; error says why."),
    "job_canceled": (409, "The job was canceled and has no result: submit the mesh again."),
    "idempotency_key_spent": (409, "The job of this Idempotency-Key was deleted: use another key."),
    "job_deleted": (410, "The job was deleted with its files: submit the mesh again."),
    "length_required": (411, "There is no body: send the mesh, with its Content-Length or in chunks."),
    "too_large": (413, "The mesh, the batch or a field is larger than this installation takes."),
    "unsupported_media_type": (415, "The body is in no format that is read here: see GET /v1/formats."),
    "range_not_satisfiable": (416, "The range lies outside the result."),
    "invalid_mesh": (422, "The mesh file is empty: send one with faces."),
    "invalid_parameters": (422, "A parameter is outside its range: see GET /v1/methods."),
    "invalid_request": (422, "A value in the path, the query or a header is not valid; detail names it."),
    "idempotency_key_reused": (
        422,
        "This Idempotency-Key was sent with another mesh or parameters: use a new one.",
    ),
    "queue_full": (429, "Too many jobs wait here: submit again after Retry-After."),
    "too_many_jobs": (429, "The caller has too many unfinished jobs: submit again when some have ended."),
    "too_many_bytes": (429, "The caller has uploaded too much in this hour: go on after Retry-After."),
    "internal_error": (500, "The server stopped at an internal error: its log has the details."),
    "queue_unavailable": (503, "The queue does not answer at the moment: try again after Retry-After."),
    "store_unavailable": (503, "The store does not answer at the moment: try again after Retry-After."),
    "insufficient_storage": (507, "The disk of the server is full: try again later or tell the operator."),
}
STATUS = {code: status for code, (status, _) in _CODES.items()}
MEANING = {code: sentence for code, (_, sentence) in _CODES.items()}
_RETRY_AFTER_S = {"not_finished": 1, "queue_unavailable": 5, "store_unavailable": 5, "insufficient_storage": 60}


class JobError(BaseModel):
    """Why a job failed."""

    code: str = Field(description="Stable, for programs.", examples=["invalid_mesh"])
    message: str = Field(description="One sentence for people.")


class ProblemDocument(BaseModel):
    """Problem details as in RFC 9457."""

    type: str = Field(examples=["about:blank"])
    title: str = Field(description="The phrase of the HTTP status.", examples=["Not Found"])
    status: int = Field(examples=[404])
    detail: str = Field(description="One sentence that says what to do.")
    code: str = Field(description="Stable, for programs.", examples=list(STATUS))
    error: JobError | None = Field(default=None, description="With code job_failed: why the job failed.")


class Problem(Exception):  # noqa: N818
    """An answer that is not what the client asked for; ``code`` is a key of STATUS."""

    def __init__(
        self, code: str, detail: str, error: JobError | None = None, headers: Mapping[str, str] | None = None
    ) -> None:
        super().__init__(detail)
        self.code = code
        self.detail = detail
        self.error = error
        self.headers = headers or {}

    def response(self, headers: Mapping[str, str] | None = None) -> Response:
        status = STATUS[self.code]
        document: dict[str, Any] = {
            "type": "about:blank",
            "title": _phrase(status),
            "status": status,
            "detail": self.detail,
            "code": self.code,
        }
        if self.error is not None:
            document["error"] = self.error.model_dump()
        own = {"Retry-After": str(_RETRY_AFTER_S[self.code])} if self.code in _RETRY_AFTER_S else {}
        if self.code == "unauthorized":
            own["WWW-Authenticate"] = "Bearer"
        # Pure ASCII: a lone surrogate that a client sent can be quoted, and NaN cannot get in.
        body = json.dumps(document, ensure_ascii=True, allow_nan=False)
        return Response(body, status, {**own, **self.headers, **(headers or {})}, MEDIA_TYPE)


def translate(exception: Exception) -> Problem:
    """The one table in which exceptions meet HTTP."""
    match exception:
        case Problem():
            return exception
        case UnknownJob():
            return Problem("job_not_found", "There is no job of this id: it was deleted, or the id is wrong.")
        case InvalidParameters():
            return Problem("invalid_parameters", str(exception))
        case RequestValidationError():
            return _invalid_request(exception)
        case HTTPException(status_code=404):
            return Problem("not_found", "There is nothing at this path: GET /openapi.json lists what there is.")
        case HTTPException(status_code=405):
            return Problem("method_not_allowed", "This path does not take this method: see the Allow header.")
        case ClientDisconnect() | HTTPException():
            return Problem("malformed_request", "The request could not be read to its end: send it again.")
        case QueueError():
            return Problem("queue_unavailable", "The queue does not answer at the moment: try again later.")
        case OSError() if is_disk_full(exception):
            return Problem("insufficient_storage", "The disk is full: try again later or tell the operator.")
        case StoreError():
            log.warning("%s", exception)
            return Problem("store_unavailable", "The store does not answer at the moment: try again later.")
    log.error("a request stopped at an error that it does not expect", exc_info=exception)
    return Problem("internal_error", "The server stopped at an internal error: its log has the details.")


def handle_problems(app: FastAPI) -> None:
    """Have every error of an application answered as a problem."""

    def answer(request: Request, exception: Exception) -> Response:
        if isinstance(exception, OSError):
            request.app.state.context.metrics.store_failed()
        return translate(exception).response(getattr(exception, "headers", None))

    kinds: tuple[type[Exception], ...] = (
        Problem,
        UnknownJob,
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
    """The ``responses`` of a route that may answer with these problems, for the OpenAPI document."""
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
    """A problem as it is sent."""
    status = STATUS[code]
    document = {
        "type": "about:blank",
        "title": _phrase(status),
        "status": status,
        "detail": MEANING[code],
        "code": code,
    }
    if code == "job_failed":
        document["error"] = {"code": "invalid_mesh", "message": "Face 3 refers to a vertex outside 0..7: [0, 1, 9]."}
    return document


def _described(status: int) -> dict[str, Any]:
    schema = {"$ref": "#/components/schemas/ProblemDocument"}
    return {"description": _phrase(status) + ":", "content": {MEDIA_TYPE: {"schema": schema, "examples": {}}}}


def _phrase(status: int) -> str:
    """The phrase of RFC 9110; Python's own differ from version to version."""
    return {413: "Content Too Large", 416: "Range Not Satisfiable", 422: "Unprocessable Content"}.get(
        status
    ) or HTTPStatus(status).phrase


def _invalid_request(exception: RequestValidationError) -> Problem:
    first = exception.errors()[0]
    place, *path = (str(part) for part in first["loc"])
    return Problem("invalid_request", f"{' '.join(path)} in the {place} is not valid: {first['msg']}.")
