"""The stored result file."""

import os
from collections.abc import Iterator
from typing import Annotated, BinaryIO

from fastapi import APIRouter, Query, Request
from starlette.responses import Response, StreamingResponse

from service.answer.renditions import IMMUTABLE, NOT_MODIFIED, answer_rendition, entity_tag, is_current
from service.answer.result_file import edited_file
from service.answer.revision import REVISION_PROBLEMS, RevisionOf
from service.context import ContextOf
from service.guard.callers import CallerOf
from service.lookup import RESULT_PROBLEMS, JobId, check_succeeded, find_job
from service.problems import documented

router = APIRouter(prefix="/v1/jobs/{job_id}", tags=["results"])

_MEDIA_TYPE = "application/octet-stream"
_CHUNK_BYTES = 1024 * 1024
_URL_VALID_S = 300.0  # set by hand: to begin the download, which may then take longer


@router.get(
    "/result.cleave",
    response_class=StreamingResponse,
    responses={
        200: {"content": {_MEDIA_TYPE: {"schema": {"type": "string", "format": "binary"}}}, "description": "The file."},
        304: {"description": NOT_MODIFIED},
        307: {
            "description": "The file is at a URL of the bucket, valid for five minutes and without credentials.",
            "headers": {"Location": {"schema": {"type": "string", "format": "uri"}}},
        },
        **documented(*RESULT_PROBLEMS, *REVISION_PROBLEMS, "invalid_request", "range_not_satisfiable"),
    },
)
def get_result_file(
    job_id: JobId,
    request: Request,
    context: ContextOf,
    caller: CallerOf,
    revision: RevisionOf,
    redirect: Annotated[bool, Query(description="If the store is a bucket, redirect to the file in it.")] = False,
) -> Response:
    """The mesh and its hierarchy in one file, which `cleave convert` converts to other formats.

    With a revision, the file also has its parts and the list of the revisions up to it.
    """
    job = find_job(context, caller, job_id)
    check_succeeded(context, job)
    if revision is not None:
        return answer_rendition(request, edited_file(context, job, revision))
    headers = {"ETag": entity_tag(f"{job.id}/result.cleave".encode()), "Cache-Control": IMMUTABLE}
    if is_current(request, headers["ETag"]):
        return Response(status_code=304, headers=headers)
    url = context.store.results.presigned_url(job.id, _URL_VALID_S) if redirect else None
    if url is not None:
        return Response(status_code=307, headers={"Location": url, "Cache-Control": "no-store"})
    return _streamed(context.store.results.open(job.id), f"{job.id}.cleave", headers)


def _streamed(file: BinaryIO, name: str, headers: dict[str, str]) -> StreamingResponse:
    headers["Content-Length"] = str(file.seek(0, os.SEEK_END))
    headers["Content-Disposition"] = f'attachment; filename="{name}"'
    file.seek(0)
    return StreamingResponse(_chunks(file), media_type=_MEDIA_TYPE, headers=headers)


def _chunks(file: BinaryIO) -> Iterator[bytes]:
    with file:
        while chunk := file.read(_CHUNK_BYTES):
            yield chunk
