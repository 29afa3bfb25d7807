"""cleave-client and cleave-viewer, installed from their archives, in Node and in pages of another origin."""

import base64
import json
import subprocess
from pathlib import Path
from typing import Any

import httpx
import pytest

from helpers.browser.meshes import small_burr
from helpers.browser.other_site import OtherSite
from helpers.browser.visit import NewVisit, Visit
from helpers.documents import blocks, read
from helpers.installation import Installation
from helpers.node.packages import bundled

GUIDE = Path("docs/how-to/frontend.md")
_HTML = '<!doctype html><html lang="en"><title>App</title><style>cleave-viewer { width: 300px; height: 300px }</style>'
_NOBODY = "http://127.0.0.1:9/"  # that the story asks in vain
_LOADED = '<script type="module" src="/app.js"></script>'
_BYTES = "Uint8Array.from(atob(bytes), (c) => c.charCodeAt(0))"


@pytest.fixture(scope="package")
def compiled(app: Path) -> Path:
    """The folder with the programs, and the example of the guide, as the newest TypeScript has compiled them."""
    (example,) = (block for block in blocks(read(GUIDE), "ts") if "cleave-client" in block)
    (app / "guide.ts").write_text(example)
    command = ["node", "node_modules/typescript/bin/tsc", "--project", "."]
    done = subprocess.run(command, cwd=app, capture_output=True, text=True, timeout=120, check=False)
    assert done.stdout == ""
    return app


def opened(visit: Visit, site: OtherSite, app: Path, program: str, ready: str) -> None:
    """Open a page of the allowed origin that runs a program; wait until it has put a function in the window."""
    site.html, site.scripts = _HTML + _LOADED, {"/app.js": bundled(app, program)}
    visit.page.goto(f"{site.allowed_origin}/")
    visit.page.wait_for_function(f"() => '{ready}' in window")


def closed(visit: Visit, site: OtherSite) -> None:
    """Check that nothing but the service and the page was asked."""
    visit.foreign = [url for url in visit.foreign if not url.startswith((f"{site.allowed_origin}/", _NOBODY))]


def check_story(facts: dict[str, Any], installation: Installation) -> None:
    job = facts.pop("job")
    assert installation.get(f"/v1/jobs/{job}").json()["max_segments"] == facts["levels"] == 9
    assert facts == {
        "last": "succeeded",
        "faces": [5120, 5120],
        "levels": 9,
        "wrong": [],
        "model": [200, "model/gltf-binary"],
        "formats": len(installation.get("/v1/formats").json()["meshes"]),
        "parts": list(range(7)),
        "files": "tetrahedron.obj",
        "refused": [422, "invalid_parameters"],
        "unknown": [404, "job_not_found"],
        "unreachable": True,
        "key": "Bearer secret",
        "streams": [["running", "succeeded"], [None, "5"]],
    }


def test_the_client_works_in_node(compiled: Path, installation: Installation) -> None:
    command = ["node", "built/node.js", installation.url]
    done = subprocess.run(command, cwd=compiled, input=small_burr(), capture_output=True, timeout=240, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    check_story(json.loads(done.stdout), installation)


def test_the_client_works_in_a_page_of_another_origin(
    new_visit: NewVisit, app: Path, installation: Installation, other_site: OtherSite
) -> None:
    visit = new_visit()
    opened(visit, other_site, app, "client.ts", "story")
    bytes_ = base64.b64encode(small_burr()).decode()
    facts = visit.page.evaluate(f"([url, bytes]) => story(url, {_BYTES})", [installation.url, bytes_])
    check_story(facts, installation)
    closed(visit, other_site)
    visit.forgive("Failed to load resource")


def test_parts_by_face_are_the_same_in_files_and_labels(
    new_visit: NewVisit, app: Path, installation: Installation, other_site: OtherSite, job: str
) -> None:
    visit = new_visit()
    opened(visit, other_site, app, "parts.ts", "compare")
    arguments = [installation.url, job, base64.b64encode(small_burr()).decode()]
    facts = visit.page.evaluate(f"([url, job, bytes]) => compare(url, job, {_BYTES})", arguments)
    labels = httpx.get(f"{installation.url}/v1/jobs/{job}/labels?segments=2").json()["labels"]
    assert [level["differing"] for level in facts["levels"]] == [[]] * len(facts["levels"])
    assert [level["seen"] for level in facts["levels"][:2]] == [1, 2]
    assert max(level["seen"] for level in facts["levels"]) > 7
    assert facts["shown"]["automatic"] == len(facts["shown"]["names"]) == 7
    assert facts["red"] == facts["ones"] == sum(labels)
    before, after, expected = facts["painted"]
    assert before == after == expected
    assert facts["refused"] == [
        "RangeError: The number of",
        "RangeError: The number of",
        "RangeError: Faces of an",
        "RangeError: The geometry has",
        "TypeError: The file was",
        "RangeError: Split 1 cuts",
    ]
    assert facts["still"]  # what is refused changes nothing
    assert facts["named"] == [5, 5, "arm"]
    assert facts["materials"] == [5, 1]  # a colour for each part; the material of the file
    closed(visit, other_site)


def test_the_viewer_and_the_parts_work_in_an_app_of_react(
    new_visit: NewVisit, compiled: Path, installation: Installation, other_site: OtherSite, job: str
) -> None:
    visit = new_visit()
    opened(visit, other_site, compiled, "react.tsx", "start")
    visit.page.evaluate("([url, job]) => start(url, job)", [installation.url, job])
    visit.page.wait_for_selector("cleave-viewer[state=loaded]")
    assert visit.page.evaluate("document.querySelector('cleave-viewer').parts.length") == 7
    visit.page.locator("cleave-viewer").click()
    visit.page.wait_for_selector("#selected:not(:empty)")
    visit.page.wait_for_selector("#scene[data-state=loaded]")
    visit.settle()
    visit.page.locator("#scene canvas").click()
    visit.page.wait_for_selector("#picked:not(:empty)")
    assert visit.page.inner_text("#picked").startswith("segment ")
    visit.page.click("text=One part")
    visit.page.wait_for_function("() => document.querySelector('cleave-viewer').parts.length === 1")
    visit.page.locator("#scene canvas").click()
    visit.page.wait_for_function("() => document.getElementById('picked').textContent === 'segment 0'")
    visit.page.click("text=Another job")
    visit.page.wait_for_function("() => document.getElementById('error').textContent === 'not_loaded'")
    assert "There is no job with this id" in visit.page.inner_text("cleave-viewer p")
    visit.forgive("404")
    closed(visit, other_site)


def test_the_viewer_can_be_imported_on_a_server(app: Path) -> None:
    code = "const { CleaveViewer } = await import('cleave-viewer'); console.log(typeof CleaveViewer)"
    command = ["node", "--input-type=module", "--eval", code]
    done = subprocess.run(command, cwd=app, capture_output=True, text=True, timeout=60, check=False)
    assert (done.stdout.strip(), done.stderr) == ("function", "")
