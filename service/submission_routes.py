"""Submitting a mesh: at once, or with the labels in the same answer."""

import re
from contextlib import ExitStack
from dataclasses import dataclass
from typing import Annotated, Any

from fastapi import APIRouter, Header, Query, Request
from starlette.concurrency import run_in_threadpool
from starlette.responses import Response

from segcore.errors import InvalidParameters
from segcore.io import FORMATS
from segcore.io.labels import labels_document
from service.access import Caller, CallerOf
from service.context import Context, ContextOf
from service.documents import JobDocument, SubmittedJobDocument
from service.form import MAX_PARAMETERS_BYTES, ReceivedMesh
from service.intake import Taken, Wish, take_in
from service.labels import compact_json
from service.limits import check_limits
from service.lookup import describe, result_of
from service.openapi import PARAMETERS
from service.problems import documented
from service.receiving import declared_length
from service.upload import FORM_TYPE, parse_parameters, receive_mesh, requested_format
from service.waiting import wait_for_end
from service.webhook import objection_to

router = APIRouter(prefix="/v1/jobs", tags=["jobs"])

_WAIT = re.compile(r"wait\s*=\s*\"?(\d{1,9})\"?", re.ASCII | re.IGNORECASE)

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
    "storage_full",
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
_BODY: dict[str, Any] = {
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
_ANSWERS: dict[int | str, dict[str, Any]] = {
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


@dataclass(frozen=True, slots=True)
class Preference:
    """What a Prefer header asks for (RFC 7240)."""

    wait_s: float
    applied: str | None  # to be told


@router.post(
    "",
    status_code=202,
    response_class=Response,
    openapi_extra=_BODY,
    responses=_ANSWERS | documented(*SUBMISSION_PROBLEMS, "idempotency_key_spent", "idempotency_key_reused"),
)
async def create_job(
    request: Request,
    context: ContextOf,
    caller: CallerOf,
    format: Annotated[  # noqa: A002
        str | None,
        Query(
            max_length=100,
            description="The format of the mesh, where neither its name nor its type say it.",
            json_schema_extra={"enum": list(FORMATS)},
            examples=["stl"],
        ),
    ] = None,
    parameters: ParametersInQuery = None,
    segments: Annotated[
        int | None, Query(ge=1, description="The number of segments of the labels in the answer.")
    ] = None,
    file_name: Annotated[str | None, Query(max_length=1000, description="What to call the mesh.")] = None,
    webhook: Webhook = None,
    prefer: Annotated[
        str | None, Header(description="wait=N: answer when the job has ended, or after N seconds.")
    ] = None,
    idempotency_key: Annotated[
        str | None,
        Header(
            min_length=1,
            max_length=255,
            description="Any text that is new for every job: a request that is sent again makes no second job.",
        ),
    ] = None,
    cache_control: Annotated[str | None, Header(description="no-cache: compute it again.")] = None,
) -> Response:
    """Submit a mesh.

    The body is the mesh file itself, or a form with the field `mesh`. The job is durable when this answers. With
    `Prefer: wait=10` the answer comes when the job has ended, and holds its labels.
    """
    # A queue that is down is said before the upload: nobody could run the job, and jobs that nobody runs would fill the
    # disk without a bound. Once the job is in the store it is accepted, and the janitor sees to the queue if need be.
    await run_in_threadpool(context.queue.connection.ping)
    check_webhook(context, webhook)
    declared = requested_format(request, format)
    limits = await run_in_threadpool(check_limits, context, caller, 1, declared_length(request))
    with ExitStack() as uploads:
        form = await receive_mesh(
            request, context.settings, lambda: uploads.enter_context(context.store.begin_upload())
        )
        wish = Wish(
            parameters=parse_parameters(form.parameters or (parameters or "").encode()),
            mesh_format=declared,
            file_name=file_name,
            webhook_url=webhook,
            idempotency_key=idempotency_key,
            may_reuse="no-cache" not in (cache_control or "").lower(),
        )
        if segments is not None and segments > wish.parameters.max_segments:
            raise InvalidParameters(f"segments must be at most max_segments = {wish.parameters.max_segments}.")
        taken = await run_in_threadpool(_take_in, context, caller, form.meshes[0], wish)
    preference = read_preference(prefer, context.settings.max_wait_s)
    if preference.wait_s:
        await wait_for_end(context.store, taken.job.id, preference.wait_s)
    return await run_in_threadpool(_answer, context, taken, preference, segments, limits)


def read_preference(prefer: str | None, most_s: float) -> Preference:
    waits = [match for part in (prefer or "").split(",") if (match := _WAIT.fullmatch(part.strip()))]
    if waits:
        wait_s = min(float(waits[0][1]), most_s)
        return Preference(wait_s, f"wait={wait_s:.0f}")
    is_async = any(part.strip().lower() == "respond-async" for part in (prefer or "").split(","))
    return Preference(0.0, "respond-async" if is_async else None)


def check_webhook(context: Context, url: str | None) -> None:
    objection = None if url is None else objection_to(url, context.settings.webhook_private_targets)
    if objection:
        raise InvalidParameters(objection)


def _take_in(context: Context, caller: Caller, mesh: ReceivedMesh, wish: Wish) -> Taken:
    taken = take_in(context, caller, mesh, wish)
    context.metrics.jobs.labels("accepted" if taken.is_new else "reused").inc()
    context.metrics.upload_bytes.inc(mesh.upload.size_bytes)
    if context.settings.key_upload_bytes_per_hour is not None:
        context.quota.add(caller.owner, mesh.upload.size_bytes)
    return taken


def _answer(
    context: Context, taken: Taken, preference: Preference, segments: int | None, limits: dict[str, str]
) -> Response:
    document = describe(context, taken.job)
    has_ended = document.finished_at is not None
    headers = {"Location": document.links.self, **limits}
    if not has_ended:
        headers["Retry-After"] = "1"
    if preference.applied:
        headers["Preference-Applied"] = preference.applied
    body = document.model_dump_json().encode()
    if has_ended:
        labels: dict[str, Any] = {"segments": None, "labels": None}
        if preference.wait_s and document.status == "succeeded":
            labels = labels_document(result_of(context, taken.job).hierarchy, segments)
        body = body[:-1] + b"," + compact_json(labels)[1:]
    return Response(body, 200 if has_ended else 202, headers, "application/json")
