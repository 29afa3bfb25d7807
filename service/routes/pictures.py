"""Pictures of the segmented mesh, and what is seen in them."""

from typing import Annotated

from fastapi import APIRouter, Depends, Query
from starlette.responses import Response

from service.answer.pictures import PNG, Camera, ViewDocument, preview_rendition, view_document
from service.answer.renditions import LEVEL_PROBLEMS, NOT_MODIFIED, answer_json, answer_rendition, rendition_responses
from service.answer.result_request import ResultRequestOf
from service.answer.revision import REVISION_PROBLEMS
from service.lookup import RESULT_PROBLEMS
from service.problems import documented

router = APIRouter(prefix="/v1/jobs/{job_id}", tags=["models"])

_PICTURE = {PNG: {"schema": {"type": "string", "format": "binary"}}}
CameraOf = Annotated[Camera, Depends()]


@router.get(
    "/preview.png",
    response_class=Response,
    responses=rendition_responses(_PICTURE, "A picture.", *LEVEL_PROBLEMS, *REVISION_PROBLEMS),
)
def get_preview(
    wanted: ResultRequestOf,
    camera: CameraOf,
    numbers: Annotated[bool, Query(description="Draw the numbers of the parts, on a white background.")] = False,
) -> Response:
    """A picture of the mesh in the colours of its segments, with a transparent background."""
    rendition = preview_rendition(wanted.context.results, wanted.cut(), camera, numbers=numbers)
    return answer_rendition(wanted.request, rendition)


@router.get(
    "/view",
    response_model=ViewDocument,
    responses=documented(*RESULT_PROBLEMS, *LEVEL_PROBLEMS, *REVISION_PROBLEMS) | {304: {"description": NOT_MODIFIED}},
)
def get_view(
    wanted: ResultRequestOf,
    camera: CameraOf,
    at: Annotated[
        list[Annotated[str, Query(max_length=11)]],
        Query(max_length=100, description="A pixel, column and row; repeated for more.", examples=[["120,80"]]),
    ] = [],  # noqa: B006
) -> Response:
    """What is seen in the picture of the same size, azimuth and elevation: the parts, and the faces at pixels."""
    document = view_document(wanted.cut(), camera, at)
    return answer_json(wanted.request, document.model_dump_json().encode())
