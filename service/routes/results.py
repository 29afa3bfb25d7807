"""Results: what is cut from the stored hierarchy of a job that succeeded, without recomputation."""

from typing import Annotated, Any

from fastapi import APIRouter, Header, Query, Request
from starlette.responses import Response

from service.answer.label_formats import LABELS, LabelsFormat, compact_json, negotiate
from service.answer.level import LevelOf
from service.answer.renditions import Rendition, answer_rendition, rendition_responses
from service.context import ContextOf
from service.documents import HierarchyDocument, LabelsDocument, RunsDocument
from service.guard.callers import CallerOf
from service.lookup import known_job, result_of
from service.openapi.document import ref
from service.problems import documented
from service.result_documents import hierarchy_of
from service.routes.jobs import JobId

router = APIRouter(prefix="/v1/jobs/{job_id}", tags=["results"])

# Why there is nothing to be fetched of a job.
NO_RESULT = ("unauthorized", "job_not_found", "job_deleted", "not_finished", "job_failed", "job_canceled")
RESULT_PROBLEMS = documented(*NO_RESULT, "range_not_satisfiable")
LEVEL_PROBLEMS = RESULT_PROBLEMS | documented("invalid_parameters", "invalid_request")

_LABELS_CONTENT: dict[str, Any] = {
    form.media_type.partition(";")[0]: {"schema": {"type": "string", "format": "binary"}} for form in LABELS.values()
} | {
    "text/plain": {"schema": {"type": "string"}, "example": "0\n0\n1\n2\n"},
    "application/json": {"schema": ref(LabelsDocument)},
    "application/vnd.cleave.runs+json": {"schema": ref(RunsDocument)},
}


@router.get(
    "/labels",
    response_class=Response,
    responses=rendition_responses(_LABELS_CONTENT, "The labels.") | LEVEL_PROBLEMS | documented("not_acceptable"),
)
def get_labels(
    job_id: JobId,
    request: Request,
    context: ContextOf,
    caller: CallerOf,
    level: LevelOf,
    format: Annotated[  # noqa: A002
        LabelsFormat | None, Query(description="The form of the labels; by default the Accept header chooses.")
    ] = None,
    accept: Annotated[str, Header(description="The media types that are taken, with weights.")] = "*/*",
) -> Response:
    """The segment of every face, in the order of the file, at any number of segments."""
    job = known_job(context, caller, job_id)
    cut = level.of(result_of(context, job))
    chosen = format or negotiate(accept)
    form = LABELS[chosen]
    return answer_rendition(
        request,
        Rendition(
            identity=f"{job.id}/labels?{cut.name}&format={chosen}",
            media_type=form.media_type,
            render=lambda: form.render(cut.result.hierarchy, cut.segments),
            file_name=None if chosen in ("json", "runs", "seg") else f"{job.id}{form.extension}",
            vary=None if format else "Accept",
        ),
    )


@router.get(
    "/hierarchy",
    response_class=Response,
    responses=rendition_responses({"application/json": {"schema": ref(HierarchyDocument)}}, "The tree.")
    | RESULT_PROBLEMS,
)
def get_hierarchy(job_id: JobId, request: Request, context: ContextOf, caller: CallerOf) -> Response:
    """The tree of cuts from which every number of segments is read, and the curve that helps to choose one."""
    job = known_job(context, caller, job_id)
    result = result_of(context, job)
    return answer_rendition(
        request,
        Rendition(
            identity=f"{job.id}/hierarchy",
            media_type="application/json",
            render=lambda: compact_json(hierarchy_of(result)),
        ),
    )
