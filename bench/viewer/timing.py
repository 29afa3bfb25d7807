"""Measures the times of the viewer in a browser."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from bench.errors import BenchmarkError

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

_LOAD_TIMEOUT_MS = 300_000  # the processor draws, and the larger mesh has 1.3 million faces

# Sets every level like the slider of the page, then waits for the frame.
_MOVES = """(levels) => {
  const viewer = document.getElementById('viewer');
  viewer.figures.frame();
  return levels.map((segments) => {
    const start = performance.now();
    viewer.cut = viewer.tree.cutAt(segments);
    const updated = performance.now();
    viewer.figures.frame();
    return [updated - start, performance.now() - updated];
  });
}"""
# Moves a brush over the middle of the model as the page does; the faces that are drawn as numbers are read before.
_STROKE = """([radius, moves]) => {
  const viewer = document.getElementById('viewer');
  const labels = viewer.labelsOfCut(viewer.cut);
  const colors = viewer.parts.map(() => '#808080');
  viewer.partition = { labels, colors: [...colors, '#f5c400'] };
  const [x, y] = [viewer.clientWidth / 2 - 60, viewer.clientHeight / 2];
  viewer.sight.at([x, y]);
  const painted = new Set();
  const reach = viewer.sight.stroke(radius);
  const times = Array.from({ length: moves }, (_, i) => {
    const start = performance.now();
    const added = reach([[x + 6 * i, y + i], [x + 6 * i + 6, y + i + 1]]);
    for (const face of added) painted.add(face);
    viewer.paint(added, colors.length);
    return performance.now() - start;
  });
  viewer.partition = null;
  return times;
}"""
_STROKES = ((18, 20), (80, 20))  # radii in CSS pixels, and moves: the first and the largest brush of the page
_LEVELS = (2, 7, 16, 30, 64)  # from the coarsest to the finest that the default parameters give


@dataclass(frozen=True, slots=True)
class Figures:
    """The times of one model in milliseconds."""

    faces: int
    shown_ms: float  # from opening a link to the first frame
    update_ms: list[float]  # of the page, for each move of the slider
    frame_ms: list[float]  # of the frame after it
    brush_ms: list[list[float]]  # of the page, for each move of a brush of each size, without the frame
    draw_calls: int


def time_of_sample(browser: Browser, url: str) -> float:
    """Return the milliseconds from a click on a sample to its first frame, including the job."""
    page = _open(browser, url)
    duration = page.evaluate(
        """() => new Promise((done, fail) => {
          const viewer = document.getElementById('viewer');
          const start = performance.now();
          viewer.addEventListener('cleave-load', () => {
            viewer.figures.frame();
            done(performance.now() - start);
          }, { once: true });
          document.querySelector('[data-sample=jack]').click();
        })"""
    )
    page.context.close()
    return float(duration)


def times_of_link(browser: Browser, url: str) -> Figures:
    """Open the link of a job and move the slider."""
    page = _open(browser, url)
    page.wait_for_selector("#work:not([hidden])", timeout=_LOAD_TIMEOUT_MS)
    page.evaluate("() => document.getElementById('viewer').figures.frame()")
    shown_ms = float(page.evaluate("() => performance.now()"))
    moves = page.evaluate(_MOVES, list(_LEVELS))
    strokes = [page.evaluate(_STROKE, list(stroke)) for stroke in _STROKES]
    faces, calls = page.evaluate(
        """() => {
          const viewer = document.getElementById('viewer');
          return [viewer.tree.node(0).faces, viewer.figures.drawCalls()];
        }"""
    )
    page.context.close()
    update_ms, frame_ms = ([move[k] for move in moves] for k in (0, 1))
    return Figures(faces, shown_ms, update_ms, frame_ms, strokes, calls)


def _open(browser: Browser, url: str) -> Page:
    page = browser.new_context(viewport={"width": 1280, "height": 800}, reduced_motion="reduce").new_page()
    page.set_default_timeout(_LOAD_TIMEOUT_MS)
    response = page.goto(url)
    if response is None or not response.ok:
        raise BenchmarkError(f"There is no viewer at {url}: start `cleave serve`, or give --url.")
    return page
