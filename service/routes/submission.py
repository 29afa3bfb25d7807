"""Submitting a mesh: at once, or with the labels in the same answer."""

from contextlib import ExitStack
from typing import Annotated, Any

from fastapi import APIRouter, Header, Query, Request
from starlette.concurrency import run_in_threadpool
from starlette.responses import Response

from cleave.logs import note_job
from segcore.errors import InvalidParameters
from segcore.io import FORMATS
from segcore.io.labels import labels_document
from segcore.levels import Fineness
from service.answer.label_formats import compact_json
from service.answer.level import Granularity
from service.answer.waiting import wait_for_end
from service.context import Context, ContextOf
from service.guard.callers import Caller, CallerOf
from service.lookup import describe, result_of
from service.problems import documented
from service.submit.body import declared_length
from service.submit.contract import ANSWERS, BODY, SUBMISSION_PROBLEMS, ParametersInQuery, Webhook
from service.submit.form import ReceivedMesh
from service.submit.intake import Taken, Wish, take_in
from service.submit.limits import check_limits
from service.submit.preference import Preference, read_preference
from service.submit.request import receive_mesh, requested_format, requested_parameters
from worker.webhooks.message import objection_to

router = APIRouter(prefix="/v1/jobs", tags=["jobs"])


@router.post(
    "",
    status_code=202,
    response_class=Response,
    openapi_extra=BODY,
    responses=ANSWERS | documented(*SUBMISSION_PROBLEMS, "idempotency_key_spent", "idempotency_key_reused"),
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
    granularity: Granularity = None,
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
    fineness = Fineness(segments, granularity)
    declared = requested_format(request, format)
    limits = await run_in_threadpool(check_limits, context, caller, 1, declared_length(request))
    with ExitStack() as uploads:
        form = await receive_mesh(
            request, context.settings, lambda: uploads.enter_context(context.store.spool.begin_upload())
        )
        wish = Wish(
            parameters=requested_parameters(form.parameters, parameters),
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
    return await run_in_threadpool(_answer, context, taken, preference, fineness, limits)


def check_webhook(context: Context, url: str | None) -> None:
    objection = None if url is None else objection_to(url, context.settings.webhook_private_targets)
    if objection:
        raise InvalidParameters(objection)


def _take_in(context: Context, caller: Caller, mesh: ReceivedMesh, wish: Wish) -> Taken:
    taken = take_in(context, caller, mesh, wish)
    note_job(taken.job.id)
    context.metrics.jobs.labels("accepted" if taken.is_new else "reused").inc()
    context.metrics.upload_bytes.inc(mesh.upload.size_bytes)
    if context.settings.key_upload_bytes_per_hour is not None:
        context.quota.add(caller.owner, mesh.upload.size_bytes)
    return taken


def _answer(
    context: Context, taken: Taken, preference: Preference, fineness: Fineness, limits: dict[str, str]
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
            hierarchy = result_of(context, taken.job).hierarchy
            labels = labels_document(hierarchy, fineness.segments_of(hierarchy))
        body = body[:-1] + b"," + compact_json(labels)[1:]
    return Response(body, 200 if has_ended else 202, headers, "application/json")
