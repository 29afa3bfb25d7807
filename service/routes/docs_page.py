"""The API reference at /docs, which loads nothing from other servers."""

from fastapi import APIRouter, Request
from starlette.responses import HTMLResponse, Response

from service.openapi.reference import markdown
from service.openapi.reference_page import html_page

router = APIRouter(include_in_schema=False)

_FOR_PROGRAMS = "For programs: [openapi.json](openapi.json)."
_STYLE = """
:root { color-scheme: light dark; --line: #8884; --code: #8882; }
* { box-sizing: border-box; }
body { font: 1rem/1.5 system-ui, sans-serif; margin: 0; display: grid; grid-template-columns: 19rem minmax(0, 1fr); }
nav { position: sticky; top: 0; height: 100vh; overflow: auto; padding: 1rem; border-right: 1px solid var(--line); }
nav ul { list-style: none; margin: .5rem 0; padding: 0; font-size: .875rem; }
nav li { overflow-wrap: anywhere; }
nav li a { display: block; padding: .2rem 0; text-decoration: none; }
nav a:hover { text-decoration: underline; }
nav .level2 { font-weight: 600; margin-top: .75rem; }
nav .level3 { padding-left: 1rem; }
summary { font-weight: 600; cursor: pointer; }
main { max-width: 62rem; padding: 1rem 2rem 4rem; min-width: 0; }
h2 { margin-top: 3rem; border-bottom: 1px solid var(--line); }
h3 { margin-top: 2.5rem; overflow-wrap: anywhere; }
code { font: .9em ui-monospace, monospace; background: var(--code); border-radius: 3px; padding: .1em .25em; }
code { overflow-wrap: anywhere; }
pre { background: var(--code); border-radius: 3px; padding: .5rem .75rem; }
pre code { background: none; padding: 0; white-space: pre-wrap; font-size: .8125rem; }
.back { display: none; }
table { border-collapse: collapse; width: 100%; margin: 1rem 0; }
td, th { text-align: left; vertical-align: top; padding: .3rem .75rem .3rem 0; border-bottom: 1px solid var(--line); }
td:first-child code { white-space: nowrap; }
@media (max-width: 50rem) {
  body { display: block; }
  nav { position: static; height: auto; max-height: 60vh; border: 0; border-bottom: 1px solid var(--line); }
  nav li a { padding: .4rem 0; }
  .back { display: block; position: fixed; right: .75rem; bottom: .75rem; padding: .6rem 1rem; border-radius: 2rem; }
  .back { background: Canvas; border: 1px solid var(--line); text-decoration: none; }
  main { padding: 1rem; }
  table, tbody, tr { display: block; width: 100%; }
  thead { display: none; }
  tr { padding: .4rem 0; border-bottom: 1px solid var(--line); }
  td { display: inline; border: 0; padding: 0 .75rem 0 0; overflow-wrap: anywhere; }
  td:first-child { font-weight: 600; }
  td:first-child code { white-space: normal; }
  td:nth-child(n + 3):last-child { display: block; padding: .1rem 0; }
  td:empty { display: none; }
}
"""


@router.get("/docs")
def get_docs(request: Request) -> HTMLResponse:
    title, _, rest = markdown(request.app.openapi()).partition("\n")
    return HTMLResponse(html_page(f"{title}\n\n{_FOR_PROGRAMS}\n{rest}"))


@router.get("/docs.css")
async def get_style() -> Response:
    return Response(_STYLE, media_type="text/css")
