"""A multipart request becomes a mesh in the store, piece by piece: it is never whole in memory."""

import json
from dataclasses import dataclass, field
from pathlib import PurePath
from typing import Any, NoReturn

from python_multipart.exceptions import FormParserError
from python_multipart.multipart import MultipartParser, parse_options_header
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request

from segcore.errors import InvalidParameters
from segcore.io.formats import declared_format
from segcore.parameters import SegmentationParameters
from service.problems import Problem
from worker.upload import MeshUpload

MAX_PARAMETERS_BYTES = 16 * 1024
_MAX_ENVELOPE_BYTES = 64 * 1024  # boundaries and headers
_LONGEST_LABEL = 255  # characters
_PIECE_BYTES = 1024 * 1024  # parsed, hashed and written at a time, off the event loop


@dataclass(slots=True)
class MeshForm:
    """What a form said beside the mesh itself."""

    file_name: str | None = None
    parameters: bytearray = field(default_factory=bytearray)  # JSON text


async def receive_form(request: Request, upload: MeshUpload, max_upload_bytes: int) -> MeshForm:
    """Stream the ``mesh`` field of a form into an upload.

    Raises
    ------
    Problem
        Where the request is no such form, is cut short or is too large; a declared length is refused before the body
        is read, an undeclared one as soon as the limit is passed.
    """
    reader = FormReader(_boundary(request), upload, max_upload_bytes)
    _check_length(_declared_length(request), max_upload_bytes)
    received, piece = 0, bytearray()
    async for chunk in request.stream():
        received += len(chunk)
        _check_length(received, max_upload_bytes)
        piece += chunk
        if len(piece) >= _PIECE_BYTES:
            await run_in_threadpool(reader.feed, bytes(piece))
            piece.clear()
    await run_in_threadpool(reader.feed, bytes(piece))
    return reader.finish()


def mesh_format(file_name: str | None) -> str | None:
    """The format that the client's name for its file stands for, None where it stands for none. The name is no path."""
    return declared_format(PurePath(file_name), None) if file_name else None


def file_label(file_name: str | None) -> str | None:
    """The client's name for its file, fit to be shown: the last part of what looks like a path, printable, not long."""
    last = (file_name or "").replace("\\", "/").rpartition("/")[2]
    return "".join(character for character in last if character.isprintable())[-_LONGEST_LABEL:].strip() or None


def parse_parameters(text: bytes | bytearray) -> SegmentationParameters:
    """The parameters of a form, defaults where it has none.

    Raises
    ------
    InvalidParameters
        Where the text is not a JSON object of known parameters in their ranges.
    """
    try:
        values = json.loads(text.decode("utf-8") or "{}", parse_constant=_refuse_constant)
    except (ValueError, RecursionError) as error:
        raise InvalidParameters("The field parameters is not JSON.") from error
    if not isinstance(values, dict):
        raise InvalidParameters('The field parameters must be a JSON object such as {"max_segments": 32}.')
    return SegmentationParameters.from_mapping(values)


class FormReader:
    """The state of one form between the pieces of its body."""

    def __init__(self, boundary: bytes, upload: MeshUpload, max_mesh_bytes: int) -> None:
        self._upload = upload
        self._max_mesh_bytes = max_mesh_bytes
        self._form = MeshForm()
        self._seen: list[str] = []
        self._header = (bytearray(), bytearray())
        self._disposition = b""
        self._is_complete = False
        self._parser = MultipartParser(boundary, self._callbacks())

    def feed(self, data: bytes) -> None:
        try:
            self._parser.write(data)
        except FormParserError as error:
            raise Problem("malformed_request", "The body is not well-formed multipart/form-data.") from error

    def finish(self) -> MeshForm:
        if not self._is_complete:
            raise Problem("malformed_request", "The form is cut short: its last boundary is missing.")
        if "mesh" not in self._seen:
            raise Problem("malformed_request", "The form has no field mesh: send the mesh file in it.")
        if self._upload.size_bytes == 0:
            raise Problem("invalid_mesh", "The mesh file is empty: send one with faces.")
        return self._form

    def _callbacks(self) -> Any:
        return {
            "on_part_begin": self._begin_part,
            "on_header_field": lambda data, start, end: self._header[0].extend(data[start:end]),
            "on_header_value": lambda data, start, end: self._header[1].extend(data[start:end]),
            "on_header_end": self._end_header,
            "on_headers_finished": self._begin_field,
            "on_part_data": self._take_data,
            "on_end": self._end,
        }

    def _begin_part(self) -> None:
        self._disposition = b""

    def _end_header(self) -> None:
        name, value = self._header
        if bytes(name).lower() == b"content-disposition":
            self._disposition = bytes(value)
        self._header = (bytearray(), bytearray())

    def _begin_field(self) -> None:
        _, options = parse_options_header(self._disposition)
        name = options.get(b"name", b"").decode("utf-8", "replace")
        if name not in ("mesh", "parameters"):
            raise Problem("malformed_request", f"There is no field {name[:80]!r}: the fields are mesh and parameters.")
        if name in self._seen:
            raise Problem("malformed_request", f"The field {name} is there twice: send one job per request.")
        self._seen.append(name)
        if name == "mesh" and b"filename" in options:
            self._form.file_name = options[b"filename"].decode("utf-8", "replace")

    def _take_data(self, data: bytes, start: int, end: int) -> None:
        if self._seen[-1] == "mesh":
            if self._upload.size_bytes + end - start > self._max_mesh_bytes:
                _refuse_size(self._max_mesh_bytes)
            self._upload.write(data[start:end])
            return
        self._form.parameters += data[start:end]
        if len(self._form.parameters) > MAX_PARAMETERS_BYTES:
            raise Problem("too_large", f"The field parameters is longer than {MAX_PARAMETERS_BYTES} bytes.")

    def _end(self) -> None:
        self._is_complete = True


def _boundary(request: Request) -> bytes:
    media_type, options = parse_options_header(request.headers.get("content-type"))
    if media_type != b"multipart/form-data" or request.headers.get("content-encoding", "identity") != "identity":
        raise Problem("unsupported_media_type", "Send the mesh as the field mesh of a multipart/form-data body.")
    boundary = options.get(b"boundary", b"")
    if not 0 < len(boundary) <= 70:
        raise Problem("malformed_request", "The Content-Type needs a boundary of 1 to 70 characters.")
    return boundary


def _declared_length(request: Request) -> int:
    declared = request.headers.get("content-length", "0")
    if not (declared.isascii() and declared.isdigit()):
        raise Problem("malformed_request", "The Content-Length is not a number.")
    return int(declared[:18])  # more digits are as much too large


def _check_length(body_bytes: int, max_upload_bytes: int) -> None:
    if body_bytes > max_upload_bytes + MAX_PARAMETERS_BYTES + _MAX_ENVELOPE_BYTES:
        _refuse_size(max_upload_bytes)


def _refuse_size(max_upload_bytes: int) -> NoReturn:
    raise Problem("too_large", f"The mesh is larger than the {max_upload_bytes} bytes that this server takes.")


def _refuse_constant(name: str) -> NoReturn:
    raise ValueError(f"{name} is not JSON")
