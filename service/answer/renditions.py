"""Responses with ETags, byte ranges and compression (RFC 9110, sections 13 and 14)."""

import gzip
import hashlib
import io
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, BinaryIO

from fastapi import Request
from starlette.responses import Response

from service.lookup import RESULT_PROBLEMS
from service.problems import Problem, documented

# Results never change, but access to them does, so that shared caches must not store them.
IMMUTABLE = "private, max-age=31536000, immutable"
REVALIDATED = "private, no-cache"  # the client asks with If-None-Match whether it has changed
_RESULT_HEADERS = {
    "ETag": {"schema": {"type": "string"}, "description": "Identifies these bytes; for If-None-Match and If-Range."},
    "Accept-Ranges": {"schema": {"const": "bytes"}},
    "Content-Encoding": {
        "schema": {"const": "gzip"},
        "description": "Of labels and the hierarchy, if Accept-Encoding allows it and no range is requested.",
    },
}
PARTIAL_CONTENT: dict[str, Any] = {
    "description": "Status 206: a piece of the bytes of a result, with its media type.",
    "headers": {
        "Content-Range": {"schema": {"type": "string"}, "description": "Its place, for example bytes 0-99/2500."},
        "ETag": {"schema": {"type": "string"}, "description": "Of the whole; for If-Range."},
    },
    "content": {"application/octet-stream": {"schema": {"type": "string", "format": "binary"}}},
}
LEVEL_PROBLEMS = ("invalid_parameters", "invalid_request")  # codes for a level that does not exist
NOT_MODIFIED = "Not modified: If-None-Match contains its ETag."
# Media types that compress well and fast; models and pictures do not.
_COMPRESSIBLE = re.compile(r"text/.*|application/(.*\+)?json|application/x-npy|application/octet-stream")
_GZIP_LEVEL = 1  # the fastest, because results are compressed for every response
_NO_QUALITY = re.compile(r"q\s*=\s*0(\.0*)?", re.IGNORECASE)
_ONE_RANGE = re.compile(r"bytes=(\d{0,18})-(\d{0,18})", re.ASCII)


@dataclass(frozen=True, slots=True, kw_only=True)
class Rendition:
    """One form of a result."""

    identity: str  # determines the bytes
    media_type: str
    render: Callable[[], bytes]
    file_name: str | None = None  # if browsers should save it rather than show it
    vary: str | None = None  # the request header that selected it
    may_change: bool = False  # the next response to the same request may have other bytes


def rendition_responses(content: dict[str, Any], description: str, *problems: str) -> dict[int | str, dict[str, Any]]:
    """Return the ``responses`` of a route that answers with a rendition, for the OpenAPI document.

    Ranges are described beside the responses, because generated types would be unions with a piece of the bytes, which
    no request without the header Range gets.
    """
    return {
        200: {
            "content": content,
            "description": f"{description} If the request has a Range header, status 206 and that piece of the bytes.",
            "headers": _RESULT_HEADERS,
            "x-partial-content": {"$ref": "#/components/responses/PartialContent"},
        },
        304: {"description": NOT_MODIFIED},
        **documented(*RESULT_PROBLEMS, "range_not_satisfiable", *problems),
    }


def to_bytes(write: Callable[[BinaryIO], object]) -> bytes:
    """Return the bytes that a function writes to a file."""
    target = io.BytesIO()
    write(target)
    return target.getvalue()


def answer_rendition(request: Request, rendition: Rendition) -> Response:
    """Return the response with the bytes of a rendition, a range of them, or status 304."""
    compressible = _COMPRESSIBLE.fullmatch(rendition.media_type.partition(";")[0]) is not None
    # Ranges refer to the uncompressed bytes: most clients would not recognize a piece of a compressed file as one.
    is_gzip = compressible and "range" not in request.headers and takes_gzip(request.headers.get("accept-encoding", ""))
    tag = rendition_tag(rendition, is_gzip=is_gzip)
    cached = REVALIDATED if rendition.may_change else IMMUTABLE
    headers = {"ETag": tag, "Cache-Control": cached, "Accept-Ranges": "bytes"}
    if compressible or rendition.vary:
        headers["Vary"] = ", ".join(filter(None, [rendition.vary, "Accept-Encoding" if compressible else None]))
    if is_current(request, tag):
        return Response(status_code=304, headers=headers)
    if rendition.file_name:
        headers["Content-Disposition"] = f'attachment; filename="{rendition.file_name}"'
    body = rendition.render()
    part = _range(request.headers.get("range"), len(body)) if request.headers.get("if-range", tag) == tag else None
    if part is not None:
        headers["Content-Range"] = f"bytes {part.start}-{part.stop - 1}/{len(body)}"
        return Response(body[part.start : part.stop], 206, headers, rendition.media_type)
    if is_gzip:
        headers["Content-Encoding"] = "gzip"
        body = gzip.compress(body, _GZIP_LEVEL, mtime=0)  # no time stamp, so that equal tags mean equal bytes
    return Response(body, 200, headers, rendition.media_type)


def rendition_tag(rendition: Rendition, *, is_gzip: bool) -> str:
    """Return the ETag of a rendition, which is another one if it is compressed."""
    return entity_tag(f"{rendition.identity}{';gzip' if is_gzip else ''}".encode())


def takes_gzip(accept_encoding: str) -> bool:
    """Return whether an Accept-Encoding header names gzip as acceptable (RFC 9110, section 12.5.3)."""
    for coding in accept_encoding.split(","):
        name, _, weight = coding.partition(";")
        if name.strip().lower() in ("gzip", "x-gzip"):
            return _NO_QUALITY.fullmatch(weight.strip()) is None
    return False


def answer_json(request: Request, body: bytes, status: int = 200, headers: Mapping[str, str] | None = None) -> Response:
    """Return a response with JSON that may change, or status 304 if the client has it."""
    tag = entity_tag(body)
    all_headers = {"ETag": tag, "Cache-Control": REVALIDATED, **(headers or {})}
    if request.method == "GET" and is_current(request, tag):
        return Response(status_code=304, headers=all_headers)
    return Response(body, status, all_headers, "application/json")


def entity_tag(identity: bytes) -> str:
    """Return the ETag for an identity."""
    return f'"{hashlib.sha256(identity).hexdigest()[:32]}"'


def is_current(request: Request, tag: str) -> bool:
    """Return whether If-None-Match contains a tag."""
    known = [candidate.strip().removeprefix("W/") for candidate in request.headers.get("if-none-match", "").split(",")]
    return tag in known or known == ["*"]


def _range(header: str | None, length: int) -> range | None:
    """Return the requested range, None for all bytes. Several ranges are answered with all bytes, as the RFC allows."""
    match = _ONE_RANGE.fullmatch(header.strip()) if header else None
    if match is None or match.groups() == ("", ""):
        return None
    first, last = match.groups()
    if not first:
        part = range(max(length - int(last), 0), length)
    else:
        part = range(int(first), min(int(last) + 1, length) if last else length)
    if last and first and int(last) < int(first):
        return None
    if not part:
        raise Problem("range_not_satisfiable", f"The range lies outside the {length} bytes of this result.")
    return part
