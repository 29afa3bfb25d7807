"""Measures the time from dropping a file on the page to its first picture, and to the full one."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from playwright.sync_api import Browser

_TIMEOUT_MS = 600_000  # the processor draws, and the largest mesh has a million faces

# Notes when a file is chosen, when its job has ended, and when each model of it has been drawn.
_LISTEN = """() => {
  const viewer = document.getElementById('viewer');
  const seen = (window.seen = { pictures: [] });
  document.getElementById('file').addEventListener('change', () => (seen.chosen = performance.now()), true);
  viewer.addEventListener('cleave-loading', () => (seen.ended = performance.now()));
  for (const name of ['cleave-coarse', 'cleave-load'])
    viewer.addEventListener(name, (event) => {
      viewer.figures.frame();
      seen.pictures.push([event.detail.faces, performance.now()]);
    });
}"""


@dataclass(frozen=True, slots=True)
class Drop:
    """The times of a dropped file in milliseconds, from the drop on."""

    faces: int
    job_ms: float  # until the page knows that the job has ended
    picture_ms: float  # until the first picture, of fewer faces perhaps
    full_ms: float  # until the picture of all faces


def dropped(browser: Browser, url: str, mesh: Path, faces: int) -> Drop:
    """Choose a file on the page of a service, and wait until all its faces are shown."""
    page = browser.new_context(viewport={"width": 1280, "height": 800}, reduced_motion="reduce").new_page()
    page.set_default_timeout(_TIMEOUT_MS)
    page.goto(url)
    page.wait_for_selector("#choose-folder", state="attached")
    page.evaluate(_LISTEN)
    page.set_input_files("#file", mesh)
    page.wait_for_function("(faces) => seen.pictures.some(([drawn]) => drawn === faces)", arg=faces)
    seen = page.evaluate("() => seen")
    page.context.close()
    (_, first), (_, last) = seen["pictures"][0], seen["pictures"][-1]
    return Drop(faces, seen["ended"] - seen["chosen"], first - seen["chosen"], last - seen["chosen"])
