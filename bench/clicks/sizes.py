"""The CPU time of clicks on meshes of several sizes."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Sequence
from functools import partial
from typing import TypeVar

import numpy as np

from bench.text import format_table

Result = TypeVar("Result")

_HEADER = ["faces", "guide s", "first ms", "next ms", "slowest ms", "smooth s"]
_CLICKS = 10
_ROUNDS = 3  # parts that are clicked at, beginning with other faces


def render_sizes(sizes: Sequence[int]) -> str:
    """Return a table: on a burr of about each number of faces, the CPU time of making a guide and of clicks.

    Clicks are at random faces, alternately inside and outside, each on the wrong side of the part that the clicks
    before it give. The first clicks of the table are made by a guide that has answered one before.
    """
    rows = [_row(faces) for faces in sizes]
    return "\n".join(["CPU time of one process.", "", format_table(_HEADER, rows)])


def _row(faces: int) -> list[str]:
    from segcore import Guide, build_surface, segment
    from segcore.shapes import burr

    subdivisions = max(1, round(np.log(faces / 20) / np.log(4)))
    mesh = burr(subdivisions).mesh
    hierarchy = segment(mesh)
    surface = build_surface(mesh)
    began = time.process_time()
    guide = Guide(mesh, hierarchy, surface)
    guide_s = time.process_time() - began
    rng = np.random.default_rng(0)
    guide.part([0])
    first: list[float] = []
    following: list[float] = []
    for _ in range(_ROUNDS):
        inside, outside = [int(rng.integers(len(mesh.faces)))], list[int]()
        part, ms = _timed(partial(guide.part, inside))
        first.append(ms)
        for click in range(1, _CLICKS):
            wrong = np.setdiff1d(np.flatnonzero(part if click % 2 else ~part), [*inside, *outside])
            if len(wrong) == 0:
                break
            (outside if click % 2 else inside).append(int(rng.choice(wrong)))
            part, ms = _timed(partial(guide.part, inside, outside))
            following.append(ms)
    _, smooth_ms = _timed(partial(guide.smooth, hierarchy.labels()))
    return [
        f"{len(mesh.faces):,}",
        f"{guide_s:.2f}",
        f"{statistics.median(first):.0f}",
        f"{statistics.median(following):.0f}",
        f"{max(following):.0f}",
        f"{smooth_ms / 1e3:.2f}",
    ]


def _timed(call: Callable[[], Result]) -> tuple[Result, float]:
    """The result of a call and its CPU time in milliseconds."""
    began = time.process_time()
    result = call()
    return result, 1e3 * (time.process_time() - began)
