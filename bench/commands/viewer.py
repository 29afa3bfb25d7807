"""How fast the viewer of a running service is in headless Chromium, and pictures of it for docs/viewer.md.

Graphics are drawn by the processor here, so times of frames are upper limits; the times of updates are what the page
itself needs for a move of the slider.
"""

from __future__ import annotations

import argparse
import statistics
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from bench.errors import BenchmarkError
from bench.text import format_table, number
from bench.viewer.browser import chromium
from bench.viewer.jobs import finished_job
from bench.viewer.pictures import take_pictures

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

_SUBDIVISIONS = (5, 8)  # of the burr: 20,480 and 1,310,720 faces
_REPETITIONS = 3
_LOAD_TIMEOUT_MS = 300_000

# Every level is set as the slider does, then the picture is waited for.
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
_LEVELS = (2, 7, 16, 30, 64)


@dataclass(frozen=True, slots=True)
class Figures:
    """Times of one model in milliseconds."""

    faces: int
    shown_ms: float  # from opening a link to the first picture
    update_ms: list[float]  # of the page, for each move of the slider
    frame_ms: list[float]  # of the picture after it
    draw_calls: int


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--url", default="http://127.0.0.1:8000", help="the service (default http://127.0.0.1:8000)")
    parser.add_argument("--chromium", type=Path, default=Path("/usr/bin/chromium"), help="the browser to use")
    parser.add_argument("--pictures", type=Path, metavar="DIR", help="where to write pictures of the page")


def run(arguments: argparse.Namespace) -> None:
    from segcore.shapes import burr

    url = arguments.url.rstrip("/")
    jobs = [finished_job(url, f"burr-{n}.ply", burr(n).mesh) for n in _SUBDIVISIONS]
    with chromium(arguments.chromium) as browser:
        samples = [_time_of_sample(browser, url) for _ in range(_REPETITIONS)]
        figures = [_measure(browser, f"{url}/#job={job}") for job in jobs]
        if arguments.pictures is not None:
            take_pictures(browser, url, jobs[-1], arguments.pictures)
    print(render(samples, figures))


def render(samples: list[float], figures: list[Figures]) -> str:
    """The figures as text."""
    rows = [
        [
            f"{one.faces:,}",
            number(one.shown_ms, 0),
            number(statistics.median(one.update_ms), 2),
            number(max(one.update_ms), 2),
            number(statistics.median(one.frame_ms), 0),
            str(one.draw_calls),
        ]
        for one in figures
    ]
    header = ["faces", "link to picture, ms", "update, ms", "longest", "frame, ms", "draw calls"]
    return "\n".join(
        [
            f"From a press on a sample to its first picture, job included: {statistics.median(samples):.0f} ms "
            f"(median of {len(samples)}).",
            "",
            format_table(header, rows),
        ]
    )


def _time_of_sample(browser: Browser, url: str) -> float:
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


def _measure(browser: Browser, url: str) -> Figures:
    page = _open(browser, url)
    page.wait_for_selector("#work:not([hidden])", timeout=_LOAD_TIMEOUT_MS)
    page.evaluate("() => document.getElementById('viewer').figures.frame()")
    shown_ms = float(page.evaluate("() => performance.now()"))
    moves = page.evaluate(_MOVES, list(_LEVELS))
    faces, calls = page.evaluate(
        """() => {
          const viewer = document.getElementById('viewer');
          return [viewer.tree.node(0).faces, viewer.figures.drawCalls()];
        }"""
    )
    page.context.close()
    return Figures(faces, shown_ms, [update for update, _ in moves], [frame for _, frame in moves], calls)


def _open(browser: Browser, url: str) -> Page:
    page = browser.new_context(viewport={"width": 1280, "height": 800}, reduced_motion="reduce").new_page()
    page.set_default_timeout(_LOAD_TIMEOUT_MS)
    answer = page.goto(url)
    if answer is None or not answer.ok:
        raise BenchmarkError(f"There is no viewer at {url}: start `cleave serve`, or give --url.")
    return page
