"""A request becomes meshes in the store, piece by piece: a mesh is never whole in memory."""

import json
from collections.abc import Callable
from pathlib import PurePath
from typing import NoReturn

from fastapi import Request
from python_multipart.multipart import parse_options_header
from starlette.concurrency import run_in_threadpool

from cleave.settings import Settings
from segcore.errors import InvalidParameters, UnsupportedFormat
from segcore.io.formats import declared_format
from segcore.parameters import SegmentationParameters
from service.problems import Problem
from service.submit.body import declared_length, pieces
from service.submit.form import (
    MAX_ENVELOPE_BYTES,
    MAX_PARAMETERS_BYTES,
    Form,
    FormReader,
    ReceivedMesh,
    refuse_size,
    write_capped,
)
from worker.jobs.store.upload import MeshUpload

FORM_TYPE = "multipart/form-data"
_ANY_BYTES = "application/octet-stream"
_LONGEST_LABEL = 255  # characters


async def receive_mesh(request: Request, settings: Settings, begin_upload: Callable[[], MeshUpload]) -> Form:
    """Stream one mesh into an upload: the field ``mesh`` of a form, or the whole body of any other request.

    Raises
    ------
    Problem
        Where there is no body, it is cut short, too slow or too large; a declared length is refused before the body is
        read, an undeclared one as soon as the limit is passed.
    """
    media_type, _ = parse_options_header(request.headers.get("content-type"))
    if media_type == FORM_TYPE.encode():
        return await receive_form(request, settings, begin_upload, settings.max_upload_bytes)
    if declared_length(request) > settings.max_upload_bytes:
        refuse_size(settings.max_upload_bytes)
    upload = begin_upload()
    async for piece in pieces(request, settings):
        await run_in_threadpool(write_capped, upload, piece, settings.max_upload_bytes)
    return Form([ReceivedMesh(upload, None)])


async def receive_form(
    request: Request,
    settings: Settings,
    begin_upload: Callable[[], MeshUpload],
    max_body_bytes: int,
    max_meshes: int = 1,
) -> Form:
    """Stream the fields ``mesh`` of a form into uploads; ``max_body_bytes`` is without what surrounds the meshes."""
    reader = FormReader(_boundary(request), begin_upload, settings.max_upload_bytes, max_meshes)
    limit = max_body_bytes + MAX_PARAMETERS_BYTES + MAX_ENVELOPE_BYTES * max_meshes
    if declared_length(request) > limit:
        refuse_size(settings.max_upload_bytes)
    received = 0
    async for piece in pieces(request, settings):
        received += len(piece)
        if received > limit:
            refuse_size(settings.max_upload_bytes)
        await run_in_threadpool(reader.feed, piece)
    return reader.finish()


def mesh_format(file_name: str | None) -> str | None:
    """The format that the client's name for its file stands for, None where it stands for none. The name is no path."""
    return declared_format(PurePath(file_name), None) if file_name else None


def requested_format(request: Request, declared: str | None) -> str | None:
    """The format that a request announces, by ``?format=`` or by the Content-Type of its body; None where neither does.

    Raises
    ------
    Problem
        Where it is none that is read here.
    """
    media_type = parse_options_header(request.headers.get("content-type"))[0].decode("latin-1")
    wanted = declared or media_type
    if declared is None and media_type in ("", _ANY_BYTES, FORM_TYPE):
        return None
    try:
        return declared_format("", wanted)
    except UnsupportedFormat as error:
        hint = (
            " Say the format with ?format= or in the Content-Type; application/octet-stream is told from its content."
        )
        raise Problem("unsupported_media_type", str(error) + hint) from error


def file_label(file_name: str | None) -> str | None:
    """The client's name for its file, fit to be shown: the last part of what looks like a path, printable, not long."""
    last = (file_name or "").replace("\\", "/").rpartition("/")[2]
    return "".join(character for character in last if character.isprintable())[-_LONGEST_LABEL:].strip() or None


def requested_parameters(in_form: bytes | bytearray, in_query: str | None) -> SegmentationParameters:
    """The parameters of a request, which may stand in the form or in the address.

    Raises
    ------
    InvalidParameters
        Where they stand in both, or are not such as ``parse_parameters`` takes.
    """
    if in_form and in_query is not None:
        raise InvalidParameters("The parameters are in the form and in the address: give them once.")
    return parse_parameters(in_form or (in_query or "").encode())


def parse_parameters(text: bytes | bytearray) -> SegmentationParameters:
    """The parameters of a request, defaults where it has none.

    Raises
    ------
    InvalidParameters
        Where the text is not a JSON object of known parameters in their ranges.
    """
    try:
        values = json.loads(text.decode("utf-8") or "{}", parse_constant=_refuse_constant)
    except (ValueError, RecursionError) as error:
        raise InvalidParameters("The parameters are not JSON.") from error
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
    raise ValueError(f"{name} is not JSON")
