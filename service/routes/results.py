"""Labels and the hierarchy, read from the stored result of a job without recomputation."""

from typing import Annotated, Any

from fastapi import APIRouter, Header, Query, Request
from starlette.responses import Response

from service.answer.label_formats import LABELS, LabelsFormat, hierarchy_json, labels_rendition
from service.answer.renditions import LEVEL_PROBLEMS, Rendition, answer_rendition, rendition_responses
from service.answer.result_request import ResultRequestOf
from service.context import ContextOf
from service.documents import HierarchyDocument, LabelsDocument, RunsDocument
from service.guard.callers import CallerOf
from service.lookup import JobId, find_job, result_of
from service.openapi.document import ref

router = APIRouter(prefix="/v1/jobs/{job_id}", tags=["results"])

_JSON = "application/json"
_LABELS_CONTENT: dict[str, Any] = {
    encoding.media_type.partition(";")[0]: {"schema": {"type": "string", "format": "binary"}}
    for encoding in LABELS.values()
} | {
    "text/plain": {"schema": {"type": "string"}, "example": "0\n0\n1\n2\n"},
    _JSON: {"schema": ref(LabelsDocument)},
    "application/vnd.cleave.runs+json": {"schema": ref(RunsDocument)},
}


@router.get(
    "/labels",
    response_class=Response,
    responses=rendition_responses(_LABELS_CONTENT, "The labels.", *LEVEL_PROBLEMS, "not_acceptable"),
)
def get_labels(
    wanted: ResultRequestOf,
    format: Annotated[  # noqa: A002
        LabelsFormat | None, Query(description="The format of the labels; by default the Accept header selects it.")
    ] = None,
    accept: Annotated[str, Header(description="Accepted media types, with weights.")] = "*/*",
) -> Response:
    """The segment of every face, in the order of the file, at any number of segments."""
    return answer_rendition(wanted.request, labels_rendition(wanted.cut(), format, accept))


@router.get(
    "/hierarchy",
    response_class=Response,
    responses=rendition_responses({_JSON: {"schema": ref(HierarchyDocument)}}, "The tree."),
)
def get_hierarchy(job_id: JobId, request: Request, context: ContextOf, caller: CallerOf) -> Response:
    """The tree of cuts, which contains every number of segments, and the curve that helps to choose one."""
    job = find_job(context, caller, job_id)
    result = result_of(context, job)
    rendition = Rendition(identity=f"{job.id}/hierarchy", media_type=_JSON, render=lambda: hierarchy_json(result))
    return answer_rendition(request, rendition)
