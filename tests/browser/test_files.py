"""The files of the page are small, and contain nothing that the content security policy forbids."""

import gzip
import re
from importlib.resources import files

import httpx
import pytest

from helpers.installation import Installation

SCRIPTS = ("cleave-viewer.js", "page.js", "viewer.js", "viewer-2.js", "original.js")


def test_the_scripts_are_small() -> None:
    contents = [files("service").joinpath("viewer", name).read_bytes() for name in SCRIPTS]
    assert sum(len(gzip.compress(content)) for content in contents) <= 250 * 1024


def test_the_page_has_no_inline_script_style_or_handler() -> None:
    page = files("service").joinpath("viewer", "index.html").read_text(encoding="utf-8")
    assert not re.search(r"<script(?![^>]* src=)|<style| style=| on[a-z]+=|javascript:", page)
    assert not re.search(r"(src|href)=\"(https?:)?//", page)


def test_the_policy_allows_only_this_server(installation: Installation) -> None:
    policy = installation.get("/").headers["Content-Security-Policy"]
    directives = dict(part.strip().split(" ", 1) for part in policy.split(";"))
    assert directives["default-src"] == "'none'"
    sources = {source for name, value in directives.items() for source in value.split()}
    assert sources <= {"'none'", "'self'", "blob:"}
    assert directives["script-src"] == "'self'"


@pytest.mark.parametrize("name", [*SCRIPTS, "cleave-viewer.d.ts", "page.css", "icon.svg", "sample-jack.png"])
def test_an_unchanged_file_is_not_sent_again(installation: Installation, name: str) -> None:
    url = f"{installation.url}/viewer/{name}"
    tag = httpx.get(url).raise_for_status().headers["ETag"]
    assert httpx.get(url, headers={"If-None-Match": tag}).status_code == 304


@pytest.mark.parametrize("path", ["/viewer/index.html", "/viewer/nothing.js", "/viewer/..%2fhome.py", "/samples/x.ply"])
def test_other_files_are_not_served(installation: Installation, path: str) -> None:
    assert installation.get(path).status_code == 404
