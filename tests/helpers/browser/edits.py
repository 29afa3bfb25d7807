"""Edits of parts on the page, and their results in the API."""

from collections.abc import Sequence
from typing import Any

import httpx
import numpy as np

from helpers.browser.visit import Visit
from helpers.waiting import wait_until
from segcore.arrays import IntArray

Point = tuple[float, float]


class EditedJob:
    """A job of its own, with the Guide of its mesh in memory, so that no request finds the server unprepared."""

    def __init__(self, url: str, name: str, mesh: bytes) -> None:
        answer = httpx.post(f"{url}/v1/jobs", files={"mesh": (name, mesh)}, timeout=60)
        assert answer.status_code in (200, 202), answer.text
        self.id = str(answer.json()["id"])
        self.url = f"{url}/v1/jobs/{self.id}"
        wait_until(lambda: self.get("").json()["status"] == "succeeded")
        part = {"op": "part", "inside": [0], "outside": [], "to": "new"}
        wait_until(lambda: self.post("/edits/preview", [part]).status_code == 200)

    def get(self, path: str, **query: Any) -> httpx.Response:
        return httpx.get(self.url + path, params=query, timeout=60)

    def post(self, path: str, operations: Sequence[dict[str, Any]], base: int = 0) -> httpx.Response:
        return httpx.post(self.url + path, json={"base": base, "operations": list(operations)}, timeout=60)

    def labels(self, **query: Any) -> IntArray:
        """(F,) the labels, by default those of the newest revision."""
        raw = self.get("/labels", format="raw", **({"revision": "latest"} | query)).content
        return np.frombuffer(raw, "<i4").astype(np.int32)

    def parts(self) -> list[dict[str, Any]]:
        return list(self.get("/revisions/latest").json()["parts"])


def choose(visit: Visit, tool: str) -> None:
    visit.page.click(f"[data-tool={tool}]")
    assert visit.page.get_attribute(f"[data-tool={tool}]", "aria-pressed") == "true"
    visit.settle()  # the options of a tool may take some of the height of the picture


def wait_for_revision(visit: Visit, number: int) -> None:
    """Wait until the page shows a revision."""
    visit.page.wait_for_function(
        "(text) => document.getElementById('edit-state').textContent.endsWith(text)", arg=f"revision {number}."
    )
    visit.settle()


def wait_for_preview(visit: Visit) -> None:
    visit.page.wait_for_selector("#tool-options .primary:enabled")


def stroke(visit: Visit, *points: Point) -> None:
    """Drag the mouse along points."""
    visit.page.mouse.move(*points[0])
    visit.page.mouse.down()
    for point in points[1:]:
        visit.page.mouse.move(*point, steps=4)
    visit.page.mouse.up()


def across(visit: Visit, part: int, share: float = 0.5) -> tuple[Point, Point]:
    """Return the ends of a level line through the visible area of a node, at a share of its height."""
    step = 8
    found = zip(visit.grid(step), visit.parts_at(visit.grid(step)), strict=True)
    inside = np.array([place for place, seen in found if seen == part])
    rows = np.unique(inside[:, 1])
    y = float(rows[int(share * (len(rows) - 1))])
    xs = inside[inside[:, 1] == y, 0]
    return (float(xs.min()) - 3 * step, y), (float(xs.max()) + 3 * step, y)
