"""The result file as it is stored: everything that was computed, in one piece."""

import os
from collections.abc import Iterator
from typing import Annotated, BinaryIO

from fastapi import APIRouter, Query, Request
from starlette.responses import Response, StreamingResponse

from service.answer.renditions import FOR_EVER, NOT_MODIFIED, entity_tag, is_current
from service.context import ContextOf
from service.guard.callers import CallerOf
from service.lookup import check_succeeded, known_job
from service.problems import documented
from service.routes.jobs import JobId
from service.routes.results import NO_RESULT

router = APIRouter(prefix="/v1/jobs/{job_id}", tags=["results"])

_MEDIA_TYPE = "application/octet-stream"
_PIECE_BYTES = 1024 * 1024
_URL_VALID_S = 300.0


@router.get(
    "/result.cleave",
    response_class=StreamingResponse,
    responses={
        200: {"content": {_MEDIA_TYPE: {"schema": {"type": "string", "format": "binary"}}}, "description": "The file."},
        304: {"description": NOT_MODIFIED},
        307: {
            "description": "The file is at an address of the bucket, for five minutes and for whoever knows it.",
            "headers": {"Location": {"schema": {"type": "string", "format": "uri"}}},
        },
        **documented(*NO_RESULT, "invalid_request"),
    },
)
def get_result_file(
    job_id: JobId,
    request: Request,
    context: ContextOf,
    caller: CallerOf,
    redirect: Annotated[
        bool, Query(description="Where the store is a bucket, answer with an address in it instead of the file.")
    ] = False,
) -> Response:
    """The mesh and its whole hierarchy in one file, which `cleave convert` turns into others."""
    job = known_job(context, caller, job_id)
    check_succeeded(context, job)
    headers = {"ETag": entity_tag(f"{job.id}/result.cleave".encode()), "Cache-Control": FOR_EVER}
    if is_current(request, headers["ETag"]):
        return Response(status_code=304, headers=headers)
    address = context.store.results.presigned_url(job.id, _URL_VALID_S) if redirect else None
    if address is not None:
        return Response(status_code=307, headers={"Location": address, "Cache-Control": "no-store"})
    file = context.store.results.open(job.id)
    headers["Content-Length"] = str(file.seek(0, os.SEEK_END))
    headers["Content-Disposition"] = f'attachment; filename="{job.id}.cleave"'
    file.seek(0)
    return StreamingResponse(_pieces(file), media_type=_MEDIA_TYPE, headers=headers)


def _pieces(file: BinaryIO) -> Iterator[bytes]:
    with file:
        while piece := file.read(_PIECE_BYTES):
            yield piece
