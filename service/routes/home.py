"""The viewer at /, a page of static files, and its sample meshes. The sources of the page are in viewer/."""

import gzip
from functools import cache
from importlib.resources import files
from typing import NamedTuple

from fastapi import APIRouter, Request
from starlette.exceptions import HTTPException
from starlette.responses import Response

from service.answer.renditions import entity_tag, is_current, takes_gzip
from service.samples import SAMPLES, sample_ply

router = APIRouter(include_in_schema=False)

# No other origins and nothing inline, so that the page can only show data of this server.
_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self' blob:; img-src 'self' blob:; "
    "form-action 'self'; base-uri 'none'; frame-ancestors 'none'"
)
_PAGE_HEADERS = {
    "Content-Security-Policy": _POLICY,
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "Cache-Control": "no-cache",
}
_FILE_HEADERS = {"X-Content-Type-Options": "nosniff", "Cache-Control": "no-cache"}
_PAGE = "index.html"
_MEDIA_TYPES = {
    ".js": "text/javascript",
    ".ts": "text/plain",
    ".css": "text/css",
    ".svg": "image/svg+xml",
    ".png": "image/png",
}


@router.get("/")
def get_home(request: Request) -> Response:
    return _answer(request, _PAGE, "text/html", _PAGE_HEADERS)


@router.get("/viewer/{name}")
def get_viewer_file(name: str, request: Request) -> Response:
    """The files of the page; pages of other origins may load <cleave-viewer>."""
    suffix = name[name.rfind(".") :]
    if name not in _files() or suffix not in _MEDIA_TYPES:
        raise HTTPException(404)
    return _answer(request, name, _MEDIA_TYPES[suffix], {**_FILE_HEADERS, "Access-Control-Allow-Origin": "*"})


@router.get("/samples/{name}.ply")
def get_sample(name: str) -> Response:
    if name not in SAMPLES:
        raise HTTPException(404)
    headers = {"Cache-Control": "max-age=86400", "X-Content-Type-Options": "nosniff"}
    return Response(sample_ply(name), headers=headers, media_type="model/ply")


class _Body(NamedTuple):
    content: bytes
    tag: str  # its ETag


def _answer(request: Request, name: str, media_type: str, headers: dict[str, str]) -> Response:
    is_packed = media_type != "image/png" and takes_gzip(request.headers.get("accept-encoding", ""))
    body = _packed(name) if is_packed else _files()[name]
    headers = {**headers, "ETag": body.tag, "Vary": "Accept-Encoding"}
    if is_current(request, body.tag):
        return Response(status_code=304, headers=headers)
    if is_packed:
        headers["Content-Encoding"] = "gzip"
    return Response(body.content, headers=headers, media_type=media_type)


@cache
def _files() -> dict[str, _Body]:
    """Return the built files by name; they are part of the package and do not change."""
    contents = {entry.name: entry.read_bytes() for entry in files("service").joinpath("viewer").iterdir()}
    return {name: _Body(content, entity_tag(content)) for name, content in contents.items()}


@cache
def _packed(name: str) -> _Body:
    """Return a file compressed with gzip, once."""
    content = gzip.compress(_files()[name].content, mtime=0)
    return _Body(content, entity_tag(content))
