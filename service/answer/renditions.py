"""Answers that a client may have already, or wants a part of: RFC 9110, sections 13 (conditions) and 14 (ranges)."""

import gzip
import hashlib
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from fastapi import Request
from starlette.responses import Response

from service.problems import Problem

# Results never change, but who may read them does.
FOR_EVER = "private, max-age=31536000, immutable"
_RESULT_HEADERS = {
    "ETag": {"schema": {"type": "string"}, "description": "Of these bytes; for If-None-Match and If-Range."},
    "Accept-Ranges": {"schema": {"const": "bytes"}},
    "Content-Encoding": {
        "schema": {"const": "gzip"},
        "description": "Of labels and the hierarchy, where Accept-Encoding takes it and no range is asked for.",
    },
}
NOT_MODIFIED = "The client has it already: If-None-Match names its ETag."
# What shrinks to a part of itself in a moment; models and pictures hardly shrink, or take long.
_SHRINKS = re.compile(r"text/.*|application/(.*\+)?json|application/x-npy|application/octet-stream")
_GZIP_LEVEL = 1
_NO_QUALITY = re.compile(r"q\s*=\s*0(\.0*)?", re.IGNORECASE)
_ONE_RANGE = re.compile(r"bytes=(\d{0,18})-(\d{0,18})", re.ASCII)


@dataclass(frozen=True, slots=True, kw_only=True)
class Rendition:
    """One form of a result."""

    identity: str  # equal for equal bytes only
    media_type: str
    render: Callable[[], bytes]
    file_name: str | None = None  # where it is to be saved rather than shown
    vary: str | None = None  # the request header that chose it


def rendition_responses(content: dict[str, Any], description: str) -> dict[int | str, dict[str, Any]]:
    """The ways in which a result is answered, for the OpenAPI document."""
    return {
        200: {"content": content, "description": description, "headers": _RESULT_HEADERS},
        206: {
            "content": {media_type: {"schema": {"type": "string", "format": "binary"}} for media_type in content},
            "description": "The range of it that was asked for.",
        },
        304: {"description": NOT_MODIFIED},
    }


def answer_rendition(request: Request, rendition: Rendition) -> Response:
    """The bytes of a result, a range of them, or that the client has them."""
    shrinks = _SHRINKS.fullmatch(rendition.media_type.partition(";")[0]) is not None
    # A range is one of the bytes themselves: most who ask for it would take a piece of a compressed file for them.
    is_gzip = shrinks and "range" not in request.headers and takes_gzip(request.headers.get("accept-encoding", ""))
    tag = entity_tag(f"{rendition.identity}{';gzip' if is_gzip else ''}".encode())
    headers = {"ETag": tag, "Cache-Control": FOR_EVER, "Accept-Ranges": "bytes"}
    chosen_by = [rendition.vary, "Accept-Encoding" if shrinks else None]
    if any(chosen_by):
        headers["Vary"] = ", ".join(filter(None, chosen_by))
    if is_current(request, tag):
        return Response(status_code=304, headers=headers)
    if rendition.file_name:
        headers["Content-Disposition"] = f'attachment; filename="{rendition.file_name}"'
    body = rendition.render()
    if request.headers.get("if-range", tag) == tag:
        part = _range(request.headers.get("range"), len(body))
        if part is not None:
            headers["Content-Range"] = f"bytes {part.start}-{part.stop - 1}/{len(body)}"
            return Response(body[part.start : part.stop], 206, headers, rendition.media_type)
    if is_gzip:
        headers["Content-Encoding"] = "gzip"
        body = gzip.compress(body, _GZIP_LEVEL, mtime=0)  # without the time: equal tags are of equal bytes
    return Response(body, 200, headers, rendition.media_type)


def takes_gzip(accept_encoding: str) -> bool:
    """Whether an Accept-Encoding header takes gzip by its name (RFC 9110, section 12.5.3)."""
    for coding in accept_encoding.split(","):
        name, _, weight = coding.partition(";")
        if name.strip().lower() in ("gzip", "x-gzip"):
            return _NO_QUALITY.fullmatch(weight.strip()) is None
    return False


def answer_json(request: Request, body: bytes, status: int = 200, headers: Mapping[str, str] | None = None) -> Response:
    """What may have changed since the client asked last."""
    tag = entity_tag(body)
    all_headers = {"ETag": tag, "Cache-Control": "private, no-cache", **(headers or {})}
    if request.method == "GET" and is_current(request, tag):
        return Response(status_code=304, headers=all_headers)
    return Response(body, status, all_headers, "application/json")


def entity_tag(identity: bytes) -> str:
    return f'"{hashlib.sha256(identity).hexdigest()[:32]}"'


def is_current(request: Request, tag: str) -> bool:
    known = [candidate.strip().removeprefix("W/") for candidate in request.headers.get("if-none-match", "").split(",")]
    return tag in known or known == ["*"]


def _range(header: str | None, length: int) -> range | None:
    """The bytes that are asked for; None where that is everything, or several ranges, which nobody has to serve."""
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
