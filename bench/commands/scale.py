"""CPU seconds by stage and peak memory of one segmentation with 20,000 to 2,000,000 faces, in one thread.

Every mesh is segmented in its own process with loaded kernels. Memory is the growth of the peak memory of the process
during the segmentation, without the mesh itself. The shapes are a dumbbell and, with --data, a model of the benchmark
whose faces are split in four repeatedly. At the end a thousand small boxes, apart and in contact, are compared with
one body of as many faces.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from bench.errors import BenchmarkError
from bench.pool import one_thread_by_default
from bench.scale.cost import Cost, cost_of
from bench.scale.shapes import crowds, dumbbells, subdivisions
from bench.text import format_table, number
from segcore.progress import STAGES

SIZES = (20_000, 60_000, 200_000, 600_000, 2_000_000)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--data", type=Path, metavar="DIR", help="the folder of the benchmark, to add a model of it")
    parser.add_argument("--model", type=int, default=125, metavar="N", help="number of that model (default 125)")
    parser.add_argument(
        "--sizes", type=int, nargs="+", default=SIZES, metavar="FACES", help="default: 20,000 to 2,000,000"
    )
    parser.add_argument("--runs", type=int, default=3, metavar="N", help="the fastest of N runs counts (default 3)")


def run(arguments: argparse.Namespace) -> None:
    if arguments.runs < 1 or min(arguments.sizes) < 100:
        raise BenchmarkError("--runs must be at least 1, and each of --sizes at least 100 faces.")
    shapes = dumbbells(arguments.sizes)
    if arguments.data is not None:
        shapes += subdivisions(arguments.data, arguments.model, max(arguments.sizes))
    with one_thread_by_default():
        costs = [cost_of(name, make, arguments.runs) for name, make in shapes]
        of_crowds = [cost_of(name, make, arguments.runs) for name, make in crowds()]
    print(render(costs))
    print()
    print(render_crowds(of_crowds))


def render(costs: Sequence[Cost]) -> str:
    """Return a line for every mesh."""
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
    """Return a line for every mesh, with the ratio of its time to that of the first one."""
    rows = [
        [cost.name, str(cost.faces), number(cost.total_s, 3), number(cost.total_s / costs[0].total_s, 2)]
        for cost in costs
    ]
    return format_table(["mesh", "faces", "total s", "ratio"], rows)
