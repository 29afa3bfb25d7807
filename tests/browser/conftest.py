"""A real service with a worker, and headless Chromium; a page that reports an error fails its test."""

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
from playwright.sync_api import Browser, sync_playwright

from helpers.browser.meshes import small_burr
from helpers.browser.other_site import OtherSite
from helpers.browser.visit import MAX_UPLOAD_BYTES, NewVisit, Visit
from helpers.installation import Installation
from helpers.node import programs
from helpers.waiting import wait_until

_CHROMIUM = Path("/usr/bin/chromium")
# The processor draws: the viewer with SwiftShader, and the rest of the page without WebGL, which is cheaper.
_ARGUMENTS = [
    *("--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"),
    *("--disable-gpu-compositing", "--disable-gpu-rasterization"),
]

# The processor draws here, twice as long with smooth edges, which no test looks at.
_PLAIN_EDGES = """
const getContext = HTMLCanvasElement.prototype.getContext;
HTMLCanvasElement.prototype.getContext = function (kind, options) {
  return getContext.call(this, kind, { ...options, antialias: false });
};
"""


@pytest.fixture(scope="package")
def other_site() -> Iterator[OtherSite]:
    with OtherSite() as site:
        yield site


@pytest.fixture(scope="package")
def installation(other_site: OtherSite) -> Iterator[Installation]:
    """A service that allows one other site."""

    class Limited(Installation):
        settings = Installation.settings | {
            "CLEAVE_MAX_UPLOAD_BYTES": str(MAX_UPLOAD_BYTES),
            "CLEAVE_CORS_ORIGINS": other_site.allowed_origin,
        }

    with Limited(workers=1) as installation:
        yield installation


@pytest.fixture(scope="package")
def browser() -> Iterator[Browser]:
    if not _CHROMIUM.exists() and "CI" not in os.environ:
        pytest.skip(f"there is no {_CHROMIUM}: install Debian's package chromium to run the tests of the viewer")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=_CHROMIUM, args=_ARGUMENTS)
        yield browser
        browser.close()


@pytest.fixture
def new_visit(installation: Installation, browser: Browser) -> Iterator[NewVisit]:
    """Open windows with options of Playwright; errors and requests to other hosts fail the test."""
    visits: list[Visit] = []

    def visit(**options: Any) -> Visit:
        settings = {"viewport": {"width": 1000, "height": 640}, "reduced_motion": "reduce"} | options
        context = browser.new_context(**settings)
        context.add_init_script(_PLAIN_EDGES)
        visits.append(Visit(context.new_page(), installation.url))
        return visits[-1]

    yield visit
    for opened in visits:
        opened.page.context.close()
        assert opened.faults == []
        assert opened.foreign == []


@pytest.fixture
def visit(new_visit: NewVisit) -> Visit:
    return new_visit()


@pytest.fixture(scope="package")
def job(installation: Installation) -> str:
    """The id of a finished job: a ball with six arms, which has seven parts at the automatic level."""
    files = {"mesh": ("burr.ply", small_burr())}
    answer = httpx.post(f"{installation.url}/v1/jobs", files=files, timeout=60)
    assert answer.status_code in (200, 202), answer.text
    path = f"/v1/jobs/{answer.json()['id']}"
    wait_until(lambda: installation.status(path) == "succeeded")
    assert installation.get(path).json()["automatic_segments"] == 7
    return str(answer.json()["id"])


@pytest.fixture(scope="package")
def axe(tmp_path_factory: pytest.TempPathFactory) -> str:
    """The script of axe-core, which checks accessibility."""
    folder = programs.install("axe", tmp_path_factory.mktemp("axe"))
    return (folder / "node_modules/axe-core/axe.min.js").read_text(encoding="utf-8")
