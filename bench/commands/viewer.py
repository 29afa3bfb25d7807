"""Times of the viewer of a running service in headless Chromium, and pictures of it for docs/viewer.md.

The processor draws the graphics, so the times of frames are upper limits. The times of updates are those of the page
alone, for one move of the slider, and for one move of a brush of two sizes.
"""

from __future__ import annotations

import argparse
import statistics
from pathlib import Path

from bench.text import format_table, number
from bench.viewer.browser import chromium
from bench.viewer.jobs import finished_job
from bench.viewer.pictures import take_pictures
from bench.viewer.timing import Figures, time_of_sample, times_of_link

_SUBDIVISIONS = (5, 8)  # of the burr: 20,480 and 1,310,720 faces
_REPETITIONS = 3  # of the sample, whose median is printed


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--url", default="http://127.0.0.1:8000", help="the service (default http://127.0.0.1:8000)")
    parser.add_argument("--chromium", type=Path, default=Path("/usr/bin/chromium"), help="the browser to use")
    parser.add_argument("--pictures", type=Path, metavar="DIR", help="write pictures of the page to this folder")


def run(arguments: argparse.Namespace) -> None:
    from segcore.shapes import burr

    url = arguments.url.rstrip("/")
    jobs = [finished_job(url, f"burr-{n}.ply", burr(n).mesh) for n in _SUBDIVISIONS]
    with chromium(arguments.chromium) as browser:
        samples = [time_of_sample(browser, url) for _ in range(_REPETITIONS)]
        figures = [times_of_link(browser, f"{url}/#job={job}") for job in jobs]
        if arguments.pictures is not None:
            take_pictures(browser, url, jobs[-1], arguments.pictures)
    print(render(samples, figures))


def render(samples: list[float], figures: list[Figures]) -> str:
    """Return the figures as text."""
    rows = [
        [
            f"{one.faces:,}",
            number(one.shown_ms, 0),
            number(statistics.median(one.update_ms), 2),
            number(max(one.update_ms), 2),
            number(statistics.median(one.frame_ms), 0),
            *(f"{number(statistics.median(stroke), 1)} ({number(max(stroke), 1)})" for stroke in one.brush_ms),
            str(one.draw_calls),
        ]
        for one in figures
    ]
    header = [
        "faces",
        "link to picture, ms",
        "update, ms",
        "longest",
        "frame, ms",
        "brush, ms (longest)",
        "largest brush",
        "draw calls",
    ]
    return "\n".join(
        [
            f"From a click on a sample to its first picture, including the job: {statistics.median(samples):.0f} ms "
            f"(median of {len(samples)}).",
            "",
            format_table(header, rows),
        ]
    )
