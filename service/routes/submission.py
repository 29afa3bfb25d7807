"""Submission of one mesh, or of that of an earlier job, optionally with the labels in the response."""

from typing import Any

from fastapi import APIRouter, Request
from starlette.concurrency import run_in_threadpool
from starlette.responses import Response

from segcore.io import labels_document
from service.answer.label_formats import labels_json, with_members
from service.answer.waiting import wait_for_end
from service.context import Context, ContextOf
from service.guard.callers import CallerOf
from service.lookup import JOB_PROBLEMS, JobId, describe, find_job, result_of
from service.problems import documented
from service.submit.contract import JOB_BODY, JOB_RESPONSES, JSON, RERUN_BODY, SUBMISSION_PROBLEMS
from service.submit.options import JobOptionsOf, RerunOptionsOf
from service.submit.preference import Preference, read_preference
from service.submit.rerun import submit_again
from service.submit.submission import Submission, submit_mesh

router = APIRouter(prefix="/v1/jobs", tags=["jobs"])


@router.post(
    "",
    status_code=202,
    response_class=Response,
    openapi_extra=JOB_BODY,
    responses=JOB_RESPONSES | documented(*SUBMISSION_PROBLEMS, "idempotency_key_spent", "idempotency_key_reused"),
)
async def create_job(request: Request, context: ContextOf, caller: CallerOf, options: JobOptionsOf) -> Response:
    """Submit a mesh.

    The body is the mesh file itself, or a form with it in the field `mesh`. The files that it refers to, such as
    materials, are further fields of that name. The job is stored before the response is sent.
    With `Prefer: wait=10` the response is sent when the job has ended, and contains its labels.
    """
    submission = await submit_mesh(request, context, caller, options)
    return await _answer(context, submission, options.prefer)


@router.post(
    "/{job_id}/rerun",
    status_code=202,
    response_class=Response,
    openapi_extra=RERUN_BODY,
    responses=JOB_RESPONSES
    | documented(*SUBMISSION_PROBLEMS, *JOB_PROBLEMS, "input_lost", "idempotency_key_spent", "idempotency_key_reused"),
)
async def rerun_job(
    job_id: JobId, request: Request, context: ContextOf, caller: CallerOf, options: RerunOptionsOf
) -> Response:
    """Submit the mesh of a job again, with other parameters: the server has its file.

    The earlier job may have ended in any way, or be unfinished; it does not change.
    """
    job = await run_in_threadpool(find_job, context, caller, job_id)
    return await _answer(context, await submit_again(request, context, caller, job, options), options.prefer)


async def _answer(context: Context, submission: Submission, prefer: str | None) -> Response:
    preference = read_preference(prefer, context.settings.max_wait_s)
    if preference.wait_s:
        await wait_for_end(context.store, context.endings, submission.receipt.job.id, preference.wait_s)
    return await run_in_threadpool(_response, context, submission, preference)


def _response(context: Context, submission: Submission, preference: Preference) -> Response:
    document = describe(context, submission.receipt.job)
    has_ended = document.finished_at is not None
    headers = {"Location": document.links.self, **submission.rate_limits}
    if not has_ended:
        headers["Retry-After"] = "1"
    if preference.applied:
        headers["Preference-Applied"] = preference.applied
    body = document.model_dump_json().encode()
    if has_ended:
        labels: dict[str, Any] = {"segments": None, "labels": None}
        if preference.wait_s and document.status == "succeeded":
            hierarchy = result_of(context, submission.receipt.job).hierarchy
            labels = labels_document(hierarchy, submission.fineness.segments_of(hierarchy))
        body = with_members(body, labels_json(labels))
    return Response(body, 200 if has_ended else 202, headers, JSON)
