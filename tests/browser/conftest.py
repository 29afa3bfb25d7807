"""A real service with a worker, and headless Chromium that looks at it; every page must stay without a fault."""

import os
import shutil
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
from playwright.sync_api import Browser, sync_playwright

from browser.meshes import small_burr
from browser.visit import Visit
from end_to_end.installation import Installation
from support import wait_until

_CHROMIUM = Path("/usr/bin/chromium")
_ARGUMENTS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"]
_AXE = Path(__file__).parent / "axe"
MOST_BYTES = 2_000_000  # that the installation takes
NewVisit = Callable[..., Visit]


class _Limited(Installation):
    settings = Installation.settings | {"CLEAVE_MAX_UPLOAD_BYTES": str(MOST_BYTES)}


@pytest.fixture(scope="session")
def installation() -> Iterator[Installation]:
    with _Limited(workers=1) as installation:
        yield installation


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    if not _CHROMIUM.exists() and "CI" not in os.environ:
        pytest.skip(f"there is no {_CHROMIUM}: install Debian's package chromium to run the tests of the viewer")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=_CHROMIUM, args=_ARGUMENTS)
        yield browser
        browser.close()


@pytest.fixture
def new_visit(installation: Installation, browser: Browser) -> Iterator[NewVisit]:
    """Open windows of any kind; whatever they report as a fault fails the test."""
    visits: list[Visit] = []

    def visit(**options: Any) -> Visit:
        settings = {"viewport": {"width": 1000, "height": 640}, "reduced_motion": "reduce"} | options
        context = browser.new_context(**settings)
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


@pytest.fixture(scope="session")
def job(installation: Installation) -> str:
    """The id of a finished job: a ball with six arms, whose automatic number of parts is seven."""
    files = {"mesh": ("burr.ply", small_burr())}
    answer = httpx.post(f"{installation.url}/v1/jobs", files=files, timeout=60)
    assert answer.status_code in (200, 202), answer.text
    path = f"/v1/jobs/{answer.json()['id']}"
    wait_until(lambda: installation.status(path) == "succeeded")
    assert installation.get(path).json()["automatic_segments"] == 7
    return str(answer.json()["id"])


@pytest.fixture(scope="session")
def axe(tmp_path_factory: pytest.TempPathFactory) -> str:
    """The script of axe-core."""
    npm = shutil.which("npm")
    if npm is None and "CI" not in os.environ:
        pytest.skip("axe-core is installed with npm, and there is none")
    folder = tmp_path_factory.mktemp("axe")
    for name in ("package.json", "package-lock.json"):
        shutil.copy(_AXE / name, folder)
    command = [npm or "npm", "ci", "--no-audit", "--no-fund", "--ignore-scripts", "--loglevel=error"]
    installed = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=120, check=False)
    if installed.returncode and "CI" not in os.environ:
        pytest.skip(f"axe-core could not be installed: {installed.stderr.strip()[-200:]}")
    return (folder / "node_modules/axe-core/axe.min.js").read_text(encoding="utf-8")
