"""Parsing of submissions: meshes are streamed into uploads, and are never entirely in memory."""

import json
from collections.abc import Callable
from pathlib import PurePath
from typing import NoReturn

from fastapi import Request
from python_multipart.multipart import parse_options_header
from starlette.concurrency import run_in_threadpool

from cleave.settings import Settings
from segcore.errors import InvalidParameters, UnsupportedFormat
from segcore.io import declared_format
from segcore.parameters import SegmentationParameters
from service.problems import Problem
from service.submit.body import body_chunks, declared_length, media_type
from service.submit.disposition import file_name_in
from service.submit.file_set import MOST_FILES, one_model
from service.submit.form import (
    MAX_ENVELOPE_BYTES,
    MAX_FILE_ENVELOPE_BYTES,
    MAX_PARAMETERS_BYTES,
    Form,
    FormReader,
    ReceivedMesh,
    refuse_size,
    write_capped,
)
from worker.jobs.store.upload import MeshUpload

FORM_TYPE = "multipart/form-data"
# Media types that declare no format of a mesh; archives contain a mesh with its files.
_UNSPECIFIED = ("", "application/octet-stream", "application/zip", "application/x-zip-compressed", FORM_TYPE)
_MAX_LABEL_LENGTH = 255  # characters, as of a file name


async def receive_mesh(request: Request, settings: Settings, begin_upload: Callable[[], MeshUpload]) -> Form:
    """Stream one mesh into an upload: the fields ``mesh`` of a form, or the whole body of any other request.

    Several fields are one mesh and the files that belong to it.

    Raises
    ------
    Problem
        If there is no body, or it is incomplete, too slow or too large. A declared length is checked before the body
        is read, an undeclared one while it is read.
    """
    if media_type(request) == FORM_TYPE:
        form = await receive_form(request, settings, begin_upload, settings.max_upload_bytes, MOST_FILES)
        form.meshes = [await run_in_threadpool(one_model, form.meshes, begin_upload, settings.max_upload_bytes)]
        return form
    if declared_length(request) > settings.max_upload_bytes:
        refuse_size(settings.max_upload_bytes)
    upload = begin_upload()
    async for chunk in body_chunks(request, settings):
        await run_in_threadpool(write_capped, upload, chunk, settings.max_upload_bytes)
    disposition = request.headers.get("content-disposition", "").encode("latin-1")
    return Form([ReceivedMesh(upload, file_name_in(disposition))])


async def receive_form(
    request: Request,
    settings: Settings,
    begin_upload: Callable[[], MeshUpload],
    max_body_bytes: int,
    max_files: int,
) -> Form:
    """Stream the fields ``mesh`` of a form into uploads; ``max_body_bytes`` does not count boundaries and headers."""
    reader = FormReader(_boundary(request), begin_upload, settings.max_upload_bytes, max_files)
    limit = max_body_bytes + MAX_PARAMETERS_BYTES + MAX_ENVELOPE_BYTES + MAX_FILE_ENVELOPE_BYTES * max_files
    if declared_length(request) > limit:
        refuse_size(settings.max_upload_bytes)
    received = 0
    async for chunk in body_chunks(request, settings):
        received += len(chunk)
        if received > limit:
            refuse_size(settings.max_upload_bytes)
        await run_in_threadpool(reader.feed, chunk)
    return reader.finish()


def mesh_format(file_name: str | None) -> str | None:
    """Return the format for the file name of a client, None if it has no known extension."""
    return declared_format(PurePath(file_name), None) if file_name else None


def requested_format(request: Request, declared: str | None) -> str | None:
    """Return the format that ``?format=`` or the Content-Type of the body declares, None if neither does.

    Raises
    ------
    Problem
        If the declared format is not supported.
    """
    content_type = media_type(request)
    if declared is None and content_type in _UNSPECIFIED:
        return None
    try:
        return declared_format("", declared or content_type)
    except UnsupportedFormat as error:
        hint = " Declare it with ?format= or the Content-Type; application/octet-stream is detected from its content."
        raise Problem("unsupported_media_type", str(error) + hint) from error


def file_label(file_name: str | None) -> str | None:
    """Return the file name of a client for display: the last part of a path, printable characters only, shortened."""
    last = (file_name or "").replace("\\", "/").rpartition("/")[2]
    return "".join(character for character in last if character.isprintable())[-_MAX_LABEL_LENGTH:].strip() or None


def requested_parameters(in_form: bytes | bytearray, in_query: str | None) -> SegmentationParameters:
    """Return the parameters of a request, given in the form or in the query.

    Raises
    ------
    InvalidParameters
        If they are given in both, or are not valid.
    """
    if in_form and in_query is not None:
        raise InvalidParameters("The parameters are in the form and in the query: give them once.")
    return parse_parameters(in_form or (in_query or "").encode())


def parse_parameters(text: bytes | bytearray) -> SegmentationParameters:
    """Return the parameters in a JSON text, with defaults for missing ones.

    Raises
    ------
    InvalidParameters
        If the text is not a JSON object of known parameters in their ranges.
    """
    try:
        values = json.loads(text.decode("utf-8") or "{}", parse_constant=_refuse_constant)
    except (ValueError, RecursionError) as error:
        raise InvalidParameters("The parameters are not valid JSON.") from error
    if not isinstance(values, dict):
        raise InvalidParameters('The parameters must be a JSON object such as {"max_segments": 32}.')
    return SegmentationParameters.from_mapping(values)


def _boundary(request: Request) -> bytes:
    _, options = parse_options_header(request.headers.get("content-type"))
    if request.headers.get("content-encoding", "identity") != "identity":
        raise Problem("unsupported_media_type", "A form cannot be compressed: compress the mesh in it instead.")
    boundary = options.get(b"boundary", b"")
    if not 0 < len(boundary) <= 70:
        raise Problem("malformed_request", "The Content-Type needs a boundary of 1 to 70 characters.")
    return boundary


def _refuse_constant(name: str) -> NoReturn:
    raise ValueError(f"{name} is not valid JSON")
