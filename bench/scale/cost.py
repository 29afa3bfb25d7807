"""Measures the CPU time by stage and the peak memory of one segmentation."""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from typing import TYPE_CHECKING

from bench.memory import peak_memory, reset_peak
from bench.pool import OF_SEGMENTATIONS
from segcore.progress import STAGES

if TYPE_CHECKING:
    from segcore.mesh import Mesh


@dataclass(frozen=True, slots=True)
class Cost:
    """CPU time, memory and progress of one segmentation."""

    name: str
    faces: int
    stage_s: dict[str, float]  # CPU seconds by stage
    memory_bytes: int  # growth of the peak memory of the process
    silence_s: float  # the most CPU seconds between two reports of progress

    @property
    def total_s(self) -> float:
        return sum(self.stage_s.values())


def cost_of(name: str, make: Callable[[], Mesh], runs: int) -> Cost:
    """Return the cost of the fastest of some runs, each in its own process.

    Parameters
    ----------
    make : returns the mesh; picklable.
    """
    costs = []
    for _ in range(runs):
        with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as process:
            costs.append(process.submit(_measure, name, make).result())
    return min(costs, key=lambda cost: cost.total_s)


def _measure(name: str, make: Callable[[], Mesh]) -> Cost:
    from segcore import warm_up
    from segcore.method import segment

    warm_up(*OF_SEGMENTATIONS)
    mesh = make()
    before = reset_peak()
    stage_s = dict.fromkeys(STAGES, 0.0)
    now, current, silence_s = time.process_time(), STAGES[0], 0.0

    def on_progress(stage: str, _: float) -> None:
        nonlocal now, current, silence_s
        then, now = now, time.process_time()
        silence_s = max(silence_s, now - then)
        stage_s[current] += now - then
        current = stage

    segment(mesh, on_progress=on_progress, threads=1)
    return Cost(name, len(mesh.faces), stage_s, peak_memory() - before, silence_s)
