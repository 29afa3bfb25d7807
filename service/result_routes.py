"""Results: what is cut from the stored hierarchy of a job that succeeded, without recomputation."""

import io
import json
from collections.abc import Callable
from typing import Annotated, Any, BinaryIO, Literal

from fastapi import APIRouter, Query, Request
from starlette.responses import Response

from segcore.io.glb import write_glb
from segcore.io.labels import hierarchy_document, labels_document
from segcore.io.png import write_png
from segcore.io.result import Segmentation
from segcore.picture import draw
from service.answers import Rendition, answer_rendition
from service.context import ContextOf
from service.documents import HierarchyDocument, LabelsDocument
from service.lookup import known_job, result_of
from service.problems import documented
from service.routes import JobId
from worker.jobs import Job

router = APIRouter(prefix="/v1/jobs/{job_id}", tags=["results"])

Segments = Annotated[
    int | None, Query(ge=1, description="The number of segments, 1 to max_segments; by default automatic_segments.")
]
GLB, PNG, JSON = "model/gltf-binary", "image/png", "application/json"

_RESULT_PROBLEMS = documented(
    "job_not_found", "job_deleted", "not_finished", "job_failed", "job_canceled", "range_not_satisfiable"
)
_LEVEL_PROBLEMS = _RESULT_PROBLEMS | documented("invalid_parameters", "invalid_request")


def _responses(content: dict[str, Any], description: str) -> dict[int | str, dict[str, Any]]:
    """The ways in which a result is answered, for the OpenAPI document."""
    return {
        200: {"content": content, "description": description},
        206: {"content": content, "description": "The range of it that was asked for."},
        304: {"description": "The client has it already: If-None-Match names its ETag."},
    }


@router.get(
    "/labels",
    response_class=Response,
    responses=_responses({JSON: {}}, "The labels.") | {200: {"model": LabelsDocument}} | _LEVEL_PROBLEMS,
)
def get_labels(job_id: JobId, request: Request, context: ContextOf, segments: Segments = None) -> Response:
    """The segment of every face, in the order of the file, at any number of segments."""
    job = known_job(context, job_id)
    result = result_of(context, job)
    count = _level(result, segments)
    return _answer(
        request, job, f"labels.json?segments={count}", JSON, lambda: _json(labels_document(result.hierarchy, count))
    )


@router.get(
    "/hierarchy",
    response_class=Response,
    responses=_responses({JSON: {}}, "The tree of cuts.") | {200: {"model": HierarchyDocument}} | _RESULT_PROBLEMS,
)
def get_hierarchy(job_id: JobId, request: Request, context: ContextOf) -> Response:
    """The tree of cuts from which every number of segments is read, and the curve that helps to choose one."""
    job = known_job(context, job_id)
    result = result_of(context, job)
    return _answer(request, job, "hierarchy.json", JSON, lambda: _json(_hierarchy(result)))


@router.get(
    "/model.glb", response_class=Response, responses=_responses({GLB: {}}, "Binary glTF 2.0.") | _LEVEL_PROBLEMS
)
def get_model(
    job_id: JobId,
    request: Request,
    context: ContextOf,
    segments: Segments = None,
    levels: Annotated[
        Literal["all"] | None,
        Query(description="Every level in one file: a node per node of the hierarchy, a material variant per level."),
    ] = None,
) -> Response:
    """The mesh as binary glTF, a named node and a colour for every segment, at any number of segments."""
    job = known_job(context, job_id)
    result = result_of(context, job)
    count = _level(result, segments)

    def write(target: BinaryIO) -> None:
        write_glb(target, result.mesh, result.hierarchy, count, all_levels=levels == "all")

    name = f"model.glb?segments={count}&levels={levels or 'one'}"
    return _answer(request, job, name, GLB, lambda: _written(write), file_name=f"{job.id}.glb")


@router.get("/preview.png", response_class=Response, responses=_responses({PNG: {}}, "A picture.") | _LEVEL_PROBLEMS)
def get_preview(
    job_id: JobId,
    request: Request,
    context: ContextOf,
    segments: Segments = None,
    size: Annotated[int, Query(ge=16, le=1024, description="Width and height in pixels.")] = 256,
) -> Response:
    """A picture of the mesh in the colours of its segments, on a transparent ground."""
    job = known_job(context, job_id)
    result = result_of(context, job)
    count = _level(result, segments)

    def render() -> bytes:
        pixels = draw(result.mesh, result.hierarchy.labels(count), size)
        return _written(lambda target: write_png(target, pixels))

    name = f"preview.png?segments={count}&size={size}"
    return _answer(request, job, name, PNG, lambda: context.results.rendered(job.id, name, render))


def _level(result: Segmentation, segments: int | None) -> int:
    """The number of segments that is meant, checked."""
    return len(result.hierarchy.segment_nodes(segments))


def _hierarchy(result: Segmentation) -> dict[str, Any]:
    document = hierarchy_document(result.hierarchy)
    nodes = result.hierarchy.split_node.tolist()
    curve = [
        {"segments": split + 2, "cut_value": value, "node": node}
        for split, (value, node) in enumerate(zip(document["cut_values"], nodes, strict=True))
    ]
    return document | {"curve": curve}


def _answer(
    request: Request, job: Job, name: str, media_type: str, render: Callable[[], bytes], file_name: str | None = None
) -> Response:
    identity = f"{job.id}/{name}"
    return answer_rendition(
        request, Rendition(identity=identity, media_type=media_type, render=render, file_name=file_name)
    )


def _written(write: Callable[[BinaryIO], object]) -> bytes:
    target = io.BytesIO()
    write(target)
    return target.getvalue()


def _json(document: dict[str, Any]) -> bytes:
    return json.dumps(document, allow_nan=False, separators=(",", ":")).encode()
