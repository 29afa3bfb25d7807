"""Labels, the hierarchy and the list of parts, read from the stored result of a job without recomputation."""

from typing import Annotated, Any

from fastapi import APIRouter, Header, Query, Request
from starlette.responses import Response

from segcore.levels import Level
from segcore.part_list.tolerance import LARGEST_TOLERANCE, TOLERANCE
from service.answer.label_formats import LABELS, LabelsFormat, LabelsOf, hierarchy_json, labels_rendition
from service.answer.part_list import PartsDocument, parts_rendition
from service.answer.renditions import LEVEL_PROBLEMS, Rendition, answer_rendition, rendition_responses
from service.answer.result_request import ResultRequestOf
from service.answer.revision import REVISION_PROBLEMS, RevisionOf, chosen_cut
from service.context import ContextOf
from service.documents import HierarchyDocument, LabelsDocument, RunsDocument
from service.guard.callers import CallerOf
from service.lookup import JobId, find_job
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
    responses=rendition_responses(
        _LABELS_CONTENT, "The labels.", *LEVEL_PROBLEMS, *REVISION_PROBLEMS, "not_acceptable"
    ),
)
def get_labels(
    wanted: ResultRequestOf,
    format: Annotated[  # noqa: A002
        LabelsFormat | None, Query(description="The format of the labels; by default the Accept header selects it.")
    ] = None,
    by: Annotated[
        LabelsOf, Query(description="The numbers of parts, or those of their classes in a revision.")
    ] = "part",
    class_names: Annotated[
        list[Annotated[str, Query(max_length=200)]] | None,
        Query(
            alias="class",
            max_length=1000,
            description="With by=class: the class that is number 1, repeated for those that follow; by default those "
            "of the revision in alphabetical order. Parts without a class have the number 0.",
        ),
    ] = None,
    accept: Annotated[str, Header(description="Accepted media types, with weights.")] = "*/*",
) -> Response:
    """The segment of every face, in the order of the file, at any number of segments or of a revision."""
    return answer_rendition(wanted.request, labels_rendition(wanted.cut(), format, accept, by, class_names or ()))


@router.get(
    "/hierarchy",
    response_class=Response,
    responses=rendition_responses({_JSON: {"schema": ref(HierarchyDocument)}}, "The tree.", *REVISION_PROBLEMS),
)
def get_hierarchy(
    job_id: JobId, request: Request, context: ContextOf, caller: CallerOf, revision: RevisionOf
) -> Response:
    """The tree of cuts, which contains every number of segments, and the curve that helps to choose one.

    The parts of a revision are the leaves of a tree of one step.
    """
    job = find_job(context, caller, job_id)
    cut = chosen_cut(context, job, Level(), revision)
    identity = f"{job.id}/hierarchy" + ("" if cut.partition is None else f"?{cut.name}")
    return answer_rendition(
        request,
        Rendition(
            identity=identity,
            media_type=_JSON,
            render=lambda: hierarchy_json(cut.result),
            may_change=cut.is_newest,
        ),
    )


@router.get(
    "/parts",
    response_class=Response,
    responses=rendition_responses(
        {_JSON: {"schema": ref(PartsDocument)}}, "The list of parts.", *LEVEL_PROBLEMS, *REVISION_PROBLEMS
    ),
)
def list_parts(
    wanted: ResultRequestOf,
    tolerance: Annotated[
        float,
        Query(
            gt=0,
            le=LARGEST_TOLERANCE,
            description="The largest deviation of congruent parts from each other, in diagonals of the box of the "
            "first one.",
        ),
    ] = TOLERANCE,
) -> Response:
    """What can be measured of every part, what it borders on, and which parts are copies of each other.

    Coordinates and lengths are those of the mesh. Copies are found whatever their place, direction and meshing, and
    whether they are mirrored.
    """
    return answer_rendition(wanted.request, parts_rendition(wanted.context.results, wanted.cut(), tolerance))
