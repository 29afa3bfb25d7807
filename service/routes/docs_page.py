"""The API reference at /docs, which loads nothing from other servers."""

from fastapi import APIRouter, Request
from starlette.responses import HTMLResponse, Response

from service.openapi.reference import html_body

router = APIRouter(include_in_schema=False)

_STYLE = """
:root { color-scheme: light dark; }
body { font: 1rem/1.5 system-ui, sans-serif; max-width: 60rem; margin: 2rem auto; padding: 0 1rem; }
h2 { margin-top: 3rem; font-size: 1.1rem; border-top: 1px solid #8886; padding-top: 1rem; overflow-wrap: anywhere; }
table { border-collapse: collapse; width: 100%; margin: 1rem 0; }
td, th { text-align: left; vertical-align: top; padding: .25rem .75rem .25rem 0; border-bottom: 1px solid #8883; }
td:first-child { font-family: ui-monospace, monospace; white-space: nowrap; }
"""


@router.get("/docs")
def get_docs(request: Request) -> HTMLResponse:
    body = html_body(request.app.openapi())
    return HTMLResponse(
        f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>Cleave API</title>'
        f'<meta name="viewport" content="width=device-width"><link rel="stylesheet" href="docs.css"></head>'
        f"<body>{body}</body></html>"
    )


@router.get("/docs.css")
async def get_style() -> Response:
    return Response(_STYLE, media_type="text/css")
