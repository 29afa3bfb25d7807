"""The page at /: a form and the way to the documentation."""

from fastapi import APIRouter
from starlette.responses import HTMLResponse

router = APIRouter(include_in_schema=False)

_PAGE = """<!doctype html>
<html lang="en">
<meta charset="utf-8">
<title>Cleave</title>
<h1>Cleave</h1>
<p>Cuts a 3D mesh into the parts that a person would name.</p>
<form action="/v1/jobs" method="post" enctype="multipart/form-data">
  <p><label>Mesh <input type="file" name="mesh" required></label> <button>Segment</button></p>
</form>
<p>The answer has the path of the job; when that says <code>succeeded</code>, its <code>links</code> lead to the labels,
the hierarchy and the coloured model. <a href="/docs">All about the API</a>, <a href="/readyz">readiness</a>.</p>
</html>
"""
_POLICY = "default-src 'none'; form-action 'self'; base-uri 'none'; frame-ancestors 'none'"


@router.get("/")
async def get_home() -> HTMLResponse:
    return HTMLResponse(_PAGE, headers={"Content-Security-Policy": _POLICY})
