"""Results: what is cut from the stored hierarchy of a job that succeeded, without recomputation."""

import io
import json
from typing import Annotated, Any

from fastapi import APIRouter, Query
from starlette.responses import Response

from segcore.io.glb import write_glb
from segcore.io.labels import hierarchy_document, labels_document
from segcore.io.result import Segmentation
from service.context import Context, ContextOf
from service.documents import HierarchyDocument, LabelsDocument
from service.problems import JobError, Problem, documented
from service.routes import JobId, known_job
from worker.jobs import Canceled, Failed, Succeeded

router = APIRouter(prefix="/v1/jobs/{job_id}", tags=["results"])

Segments = Annotated[
    int | None, Query(ge=1, description="The number of segments, 1 to max_segments; by default automatic_segments.")
]
GLB = "model/gltf-binary"

_RESULT_PROBLEMS = documented("job_not_found", "not_finished", "job_failed", "job_canceled")
_LEVEL_PROBLEMS = documented(
    "job_not_found", "not_finished", "job_failed", "job_canceled", "invalid_parameters", "invalid_request"
)


@router.get(
    "/labels",
    response_class=Response,
    responses={200: {"model": LabelsDocument, "description": "The labels."}, **_LEVEL_PROBLEMS},
)
def get_labels(job_id: JobId, context: ContextOf, segments: Segments = None) -> Response:
    """The segment of every face, in the order of the file, at any number of segments."""
    return _json(labels_document(_result(context, job_id).hierarchy, segments))


@router.get(
    "/hierarchy",
    response_class=Response,
    responses={200: {"model": HierarchyDocument, "description": "The tree of cuts."}, **_RESULT_PROBLEMS},
)
def get_hierarchy(job_id: JobId, context: ContextOf) -> Response:
    """The tree of cuts from which every number of segments is read."""
    return _json(hierarchy_document(_result(context, job_id).hierarchy))


@router.get(
    "/model.glb",
    response_class=Response,
    responses={200: {"content": {GLB: {}}, "description": "A node and a colour per segment."}, **_LEVEL_PROBLEMS},
)
def get_model(job_id: JobId, context: ContextOf, segments: Segments = None) -> Response:
    """The mesh as binary glTF, a named node and a colour for every segment, at any number of segments."""
    result, target = _result(context, job_id), io.BytesIO()
    write_glb(target, result.mesh, result.hierarchy, segments)
    return Response(
        target.getvalue(), headers={"Content-Disposition": f'attachment; filename="{job_id}.glb"'}, media_type=GLB
    )


def _result(context: Context, job_id: str) -> Segmentation:
    job = known_job(context, job_id)
    match context.store.outcome(job.id):
        case Succeeded():
            return context.results.get(job.id)
        case Failed(code=code, message=message):
            raise Problem("job_failed", f"The job failed: {message}", JobError(code=code, message=message))
        case Canceled():
            raise Problem("job_canceled", "The job was canceled and has no result: submit the mesh again.")
        case None:
            raise Problem("not_finished", "The job has not finished: poll it until its status is succeeded.")


def _json(document: dict[str, Any]) -> Response:
    body = json.dumps(document, allow_nan=False, separators=(",", ":"))
    return Response(body, media_type="application/json")
