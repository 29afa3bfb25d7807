"""The program of docs/how-to/configurator.md."""

import base64
from collections.abc import Iterator
from pathlib import Path

import pytest

from helpers.browser.meshes import small_burr
from helpers.browser.other_site import OtherSite
from helpers.browser.visit import NewVisit, Visit
from helpers.documents import blocks, read
from helpers.installation import Installation
from helpers.node.packages import bundled

GUIDE = read(Path("docs/how-to/configurator.md"))
_PIXEL = """async ([bytes, x, y]) => {
  const image = await createImageBitmap(await (await fetch(`data:image/png;base64,${bytes}`)).blob());
  const context = new OffscreenCanvas(image.width, image.height).getContext('2d');
  context.drawImage(image, 0, 0);
  return [...context.getImageData(x, y, 1, 1).data];
}"""


@pytest.fixture
def page(new_visit: NewVisit, app: Path, installation: Installation, other_site: OtherSite) -> Iterator[Visit]:
    """The page as it is saved and bundled by its readers, on a site that the service allows."""
    (html,) = blocks(GUIDE, "html")
    program = max(blocks(GUIDE, "js"), key=len)
    (app / "configurator.js").write_text(program.replace("http://127.0.0.1:8000", installation.url))
    other_site.html, other_site.scripts = html, {"/app.js": bundled(app, "configurator.js")}
    visit = new_visit()
    visit.url = other_site.allowed_origin
    yield visit
    visit.foreign = [url for url in visit.foreign if not url.startswith(installation.url)]


def middle(visit: Visit) -> tuple[float, float]:
    box = visit.page.locator("canvas").bounding_box()
    assert box is not None
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def is_red(visit: Visit) -> bool:
    visit.settle()
    picture = base64.b64encode(visit.page.screenshot()).decode()
    red, green, blue, _ = visit.page.evaluate(_PIXEL, [picture, *middle(visit)])
    return bool(red > 120 and max(green, blue) < 0.6 * red)


def test_a_material_is_chosen_for_a_part_and_stays_with_its_pieces(page: Visit, job: str) -> None:
    page.open(f"?job={job}")
    page.page.wait_for_function("() => document.getElementById('message').textContent === '7 parts: choose one.'")
    assert page.page.locator("#order").inner_text().count("to be chosen") == 7
    page.page.mouse.click(*middle(page))
    assert page.page.inner_text("#message").endswith(" is selected.")
    assert not is_red(page)
    page.page.click("text=red")
    assert is_red(page)
    assert page.page.locator("#order").inner_text().count("red") == 1
    page.set_range("level", 12)
    assert page.page.locator("#order").inner_text().count("; ") == 11
    assert is_red(page)
    page.set_range("level", 1)
    assert page.page.locator("#order").inner_text() == "segment 0: to be chosen"
    assert not is_red(page)


def test_a_mesh_is_sent_and_opened(page: Visit) -> None:
    page.open()
    mesh = {"name": "burr.ply", "mimeType": "application/octet-stream", "buffer": small_burr()}
    page.page.set_input_files("#file", mesh)  # type: ignore[arg-type]
    page.page.wait_for_function("() => document.getElementById('message').textContent === '7 parts: choose one.'")
    assert "?job=" in page.page.url
    page.page.set_input_files("#file", mesh | {"name": "no.ply", "buffer": b"no mesh"})  # type: ignore[arg-type]
    page.page.wait_for_function("() => document.getElementById('message').textContent.startsWith('The job has no')")
