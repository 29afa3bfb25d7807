"""Processor seconds, by stage, and peak memory of one segmentation, from 20,000 to 2,000,000 faces, in one thread.

Every mesh is segmented in a process of its own, with kernels loaded. Memory is the growth of the peak of the process
during the segmentation; what the mesh itself takes is not in it. Two shapes: a dumbbell meshed as finely as wanted,
and, with --data, a model of the benchmark whose faces are cut in four again and again. At the end a thousand small
boxes, far apart and touching, against one body of as many faces.
"""

from __future__ import annotations

import argparse
import resource
import sys
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import TYPE_CHECKING

from bench.errors import BenchmarkError
from bench.pool import one_thread_per_process
from bench.princeton.dataset import read_models
from bench.text import format_table, number

if TYPE_CHECKING:
    from segcore.mesh import Mesh

SIZES = (20_000, 60_000, 200_000, 600_000, 2_000_000)
STAGES = ("clean", "affinity", "coarsen", "cut", "label")


@dataclass(frozen=True, slots=True)
class Cost:
    """What one segmentation took."""

    name: str
    faces: int
    stage_s: dict[str, float]  # processor seconds by stage
    memory_bytes: int  # growth of the peak memory of the process

    @property
    def total_s(self) -> float:
        return sum(self.stage_s.values())


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--data", type=Path, metavar="DIR", help="the folder of the benchmark, for a model of it")
    parser.add_argument("--model", type=int, default=125, metavar="N", help="number of that model (default 125)")
    parser.add_argument("--sizes", type=int, nargs="+", default=SIZES, metavar="FACES", help="by default 20,000 to 2 M")
    parser.add_argument("--runs", type=int, default=3, metavar="N", help="the quickest of N runs counts (default 3)")


def run(arguments: argparse.Namespace) -> None:
    if arguments.runs < 1 or min(arguments.sizes) < 100:
        raise BenchmarkError("--runs must be at least 1, and every one of --sizes at least 100 faces.")
    shapes: list[tuple[str, Callable[[], Mesh]]] = [("dumbbell", partial(_dumbbell, size)) for size in arguments.sizes]
    if arguments.data is not None:
        shapes += _subdivisions(arguments.data, arguments.model, max(arguments.sizes))
    crowds = [("one body", partial(_dumbbell, 12_000)), ("1,000 boxes apart", partial(_boxes, 2.0))]
    crowds.append(("1,000 boxes that touch", partial(_boxes, 1.0)))
    with one_thread_per_process():
        costs = [cost_of(name, make, arguments.runs) for name, make in shapes]
        of_crowds = [cost_of(name, make, arguments.runs) for name, make in crowds]
    print(render(costs))
    print()
    print(render_crowds(of_crowds))


def cost_of(name: str, make: Callable[[], Mesh], runs: int) -> Cost:
    """The quickest of some runs, each in a process of its own."""
    costs = []
    for _ in range(runs):
        with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as process:
            costs.append(process.submit(_measure, name, make).result())
    return min(costs, key=lambda cost: cost.total_s)


def _measure(name: str, make: Callable[[], Mesh]) -> Cost:
    from segcore.method import segment
    from segcore.warm_up import warm_up

    warm_up()
    mesh = make()
    before = _forget_peak()
    stage_s = dict.fromkeys(STAGES, 0.0)
    now, current = time.process_time(), STAGES[0]

    def on_progress(stage: str, _: float) -> None:
        nonlocal now, current
        then, now = now, time.process_time()
        stage_s[current] += now - then
        current = stage

    segment(mesh, on_progress=on_progress)
    return Cost(name, len(mesh.faces), stage_s, _peak_memory() - before)


def _forget_peak() -> int:
    """Let the peak memory start from what the process has now, where the system can do that; bytes."""
    try:
        Path("/proc/self/clear_refs").write_text("5", encoding="ascii")
    except OSError:
        return _peak_memory()
    return _peak_memory()


def _peak_memory() -> int:
    try:
        lines = Path("/proc/self/status").read_text(encoding="ascii").splitlines()
    except OSError:
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1024)
    return next(1024 * int(line.split()[1]) for line in lines if line.startswith("VmHWM:"))


def _dumbbell(faces: int) -> Mesh:
    from segcore.shapes import dumbbell

    around = max(3, round((faces / 4) ** 0.5))
    return dumbbell(rings=max(2, round(faces / (2 * around))), around=around).mesh


def _boxes(spacing: float) -> Mesh:
    from segcore.shapes import box, joined

    places = [(spacing * x, spacing * y, spacing * z) for x in range(10) for y in range(10) for z in range(10)]
    return joined(*[box(centre=place) for place in places]).mesh


def _subdivisions(folder: Path, number_of_model: int, largest: int) -> list[tuple[str, Callable[[], Mesh]]]:
    models = [model for model in read_models(folder) if model.number == number_of_model]
    if not models:
        raise BenchmarkError(f"There is no model {number_of_model} in {folder}.")
    faces = len(models[0].read_mesh().faces)
    name = f"{models[0].category} {number_of_model}"
    times = 0
    chosen: list[tuple[str, Callable[[], Mesh]]] = []
    while faces * 4**times <= 1.5 * largest:
        chosen.append((name, partial(_subdivided, folder, number_of_model, times)))
        times += 1
    return chosen


def _subdivided(folder: Path, number_of_model: int, times: int) -> Mesh:
    from segcore.mesh import Mesh
    from segcore.shapes import subdivide

    mesh = next(model for model in read_models(folder) if model.number == number_of_model).read_mesh()
    vertices, faces = mesh.vertices, mesh.faces
    for _ in range(times):
        vertices, faces = subdivide(vertices, faces)
    return Mesh(vertices, faces)


def render(costs: Sequence[Cost]) -> str:
    header = ["mesh", "faces", *STAGES, "total s", "us/face", "MB", "bytes/face"]
    rows = [
        [
            cost.name,
            str(cost.faces),
            *(number(cost.stage_s[stage], 3) for stage in STAGES),
            number(cost.total_s, 3),
            number(1e6 * cost.total_s / cost.faces, 2),
            number(cost.memory_bytes / 1e6, 0),
            number(cost.memory_bytes / cost.faces, 0),
        ]
        for cost in costs
    ]
    return format_table(header, rows)


def render_crowds(costs: Sequence[Cost]) -> str:
    rows = [
        [cost.name, str(cost.faces), number(cost.total_s, 3), number(cost.total_s / costs[0].total_s, 2)]
        for cost in costs
    ]
    return format_table(["mesh", "faces", "total s", "ratio"], rows)
