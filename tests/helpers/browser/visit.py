"""Actions of a user in the viewer, and what the page shows."""

import base64
from collections.abc import Callable
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs, urlsplit

from playwright.sync_api import Page, Request

MAX_UPLOAD_BYTES = 2_000_000  # that the installation of the browser tests accepts
_DROP = """([name, content]) => {
  const bytes = Uint8Array.from(atob(content), (c) => c.charCodeAt(0));
  const transfer = new DataTransfer();
  transfer.items.add(new File([bytes], name));
  for (const kind of ['dragenter', 'dragover', 'drop'])
    window.dispatchEvent(new DragEvent(kind, { dataTransfer: transfer, bubbles: true, cancelable: true }));
}"""
_COLORS = """async (places) => {
  const viewer = document.querySelector('cleave-viewer');
  const image = await createImageBitmap(await viewer.picture());
  const canvas = new OffscreenCanvas(image.width, image.height);
  const context = canvas.getContext('2d');
  context.drawImage(image, 0, 0);
  const box = viewer.getBoundingClientRect();
  const scale = image.width / box.width;
  return places.map(([x, y]) => [...context.getImageData((x - box.left) * scale, (y - box.top) * scale, 1, 1).data]);
}"""
_PARTS = """(places) => {
  const viewer = document.querySelector('cleave-viewer');
  return places.map(([x, y]) => viewer.partAt(x, y));
}"""


class Visit:
    """A window. ``faults`` are errors that the page reported, ``foreign`` are requests to other hosts."""

    def __init__(self, page: Page, url: str) -> None:
        self.page = page
        self.url = url
        self.faults: list[str] = []
        self.foreign: list[str] = []
        self.requests: list[str] = []
        page.set_default_timeout(90_000)  # for busy machines; set by hand
        page.on("console", lambda message: self.faults.append(message.text) if message.type == "error" else None)
        page.on("pageerror", lambda error: self.faults.append(str(error)))
        page.on("request", self._note)

    def forgive(self, *words: str) -> None:
        """Drop the faults that a test has caused on purpose: those that contain one of some words."""
        self.faults = [fault for fault in self.faults if not any(word in fault for word in words)]

    def _note(self, request: Request) -> None:
        if request.url.endswith("/icon.svg"):
            return  # the browser requests it again on every change of the address
        self.requests.append(request.url)
        if not request.url.startswith((self.url, "blob:", "data:")):
            self.foreign.append(request.url)

    def open(self, fragment: str = "") -> None:
        self.page.goto(f"{self.url}/{fragment}")

    def open_job(self, job: str, state: str = "") -> None:
        """Open the link of a result."""
        self.page.goto("about:blank")
        self.open(f"#job={job}{state}")
        self.wait_for_parts()

    def wait_for_parts(self) -> None:
        self.page.wait_for_selector("#work:not([hidden]) #side [data-id]")

    def drop(self, name: str, content: bytes) -> None:
        self.page.evaluate(_DROP, [name, base64.b64encode(content).decode()])

    def drop_paths(self, *paths: Path) -> None:
        """Drop files and folders of the disk, as from a file manager."""
        session = self.page.context.new_cdp_session(self.page)
        data = {"items": [], "files": [str(path) for path in paths], "dragOperationsMask": 1}
        for kind in ("dragEnter", "dragOver", "drop"):
            session.send("Input.dispatchDragEvent", {"type": kind, "x": 200, "y": 300, "data": data})

    def set_range(self, name: str, value: int) -> None:
        """Move a slider and release it."""
        self.page.evaluate(
            """([id, value]) => {
              const range = document.getElementById(id);
              range.value = value;
              range.dispatchEvent(new Event('input'));
              range.dispatchEvent(new Event('change'));
            }""",
            [name, value],
        )

    def grid(self, step: int = 40) -> list[tuple[float, float]]:
        """Return a grid of points in the picture, in pixels of the window."""
        box = self.page.locator("#viewer").bounding_box()
        assert box is not None
        columns = range(step // 2, int(box["width"]), step)
        rows = range(step // 2, int(box["height"]), step)
        return [(box["x"] + x, box["y"] + y) for x in columns for y in rows]

    def parts_at(self, places: list[tuple[float, float]]) -> list[int]:
        return list(self.page.evaluate(_PARTS, places))

    def colors_at(self, places: list[tuple[float, float]]) -> list[list[int]]:
        """Return red, green, blue and opacity, 0..255, at each point."""
        return list(self.page.evaluate(_COLORS, places))

    def place_of(self, part: int) -> tuple[float, float]:
        """Return a point near the centre of the visible area of a part."""
        places = self.grid(self.page.viewport_size["width"] // 60 if self.page.viewport_size else 16)
        parts = self.parts_at(places)
        inside = [place for place, found in zip(places, parts, strict=True) if found == part]
        assert inside, f"part {part} is not visible"
        middle = [sum(values) / len(inside) for values in zip(*inside, strict=True)]
        return min(inside, key=lambda place: (place[0] - middle[0]) ** 2 + (place[1] - middle[1]) ** 2)

    def settle(self) -> None:
        """Wait until the page is drawn after the last change."""
        self.page.evaluate("() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")

    def rest(self) -> None:
        """Wait until the camera has stopped and the address is up to date."""
        before = None
        while (now := (self.viewer("JSON.stringify(v.view)"), self.page.url)) != before:
            before = now
            self.page.wait_for_timeout(800)

    def viewer(self, expression: str) -> Any:
        """Evaluate a JavaScript expression of the viewer ``v``."""
        return self.page.evaluate(f"() => {{ const v = document.getElementById('viewer'); return {expression}; }}")

    def parts(self) -> list[int]:
        return list(self.viewer("v.parts"))

    def splittable(self) -> int:
        """Return the first part that has cuts below it."""
        return next(part for part in self.parts() if self.viewer(f"v.tree.node({part}).children.length"))

    def selected(self) -> list[int]:
        return list(self.viewer("[...v.selected]"))

    def rows(self) -> list[str]:
        """Return the names in the list of parts."""
        return self.page.locator("#list .name").all_inner_texts()

    def address(self, holding: str = "") -> dict[str, str]:
        """Wait until the address contains a text, and return the values of its fragment."""
        self.page.wait_for_function("(text) => location.hash.includes(text)", arg=holding)
        values = parse_qs(urlsplit(self.page.url).fragment)
        return {name: found[0] for name, found in values.items()}

    def row(self, part: int) -> Any:
        return self.page.locator(f"#side [data-id='{part}']:visible")

    def show_tree(self) -> None:
        """Show the parts as a tree instead of a list."""
        self.page.click("#arrangement label:has([value=tree])")


NewVisit = Callable[..., Visit]
