"""CPU seconds by stage and peak memory of one segmentation with 20,000 to 2,000,000 faces, in one thread.

Every mesh is segmented in its own process with loaded kernels. Memory is the growth of the peak memory of the process
during the segmentation, without the mesh itself. The silence is the longest time between two reports of progress. The
shapes are a dumbbell and, with --data, a model of the benchmark whose faces are split in four repeatedly. At the end a
thousand small boxes, apart and in contact, are compared with one body of as many faces. With --hard, legal meshes that
are hard for their size (surfaces that cross themselves, edges and vertices with very many faces, very many components)
are compared with smooth ones of as many faces instead. With --from, this version is compared with another one, by CPU
and wall time and memory of a dumbbell of the largest of --sizes, in one thread and in two.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from bench.checkout import checked_out
from bench.errors import BenchmarkError
from bench.pool import one_thread_by_default
from bench.scale import versions
from bench.scale.cost import Cost, cost_of
from bench.scale.shapes import crowds, dumbbells, hard_and_smooth, subdivisions
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
    parser.add_argument("--hard", action="store_true", help="measure hard meshes beside smooth ones of their size")
    parser.add_argument("--from", dest="base", metavar="COMMIT", help="compare with this version in place of these")
    parser.add_argument(
        "--lines", type=int, metavar="N", help="with --from: the N lines of segcore that take the most time"
    )


def run(arguments: argparse.Namespace) -> None:
    if arguments.runs < 1 or min(arguments.sizes) < 100:
        raise BenchmarkError("--runs must be at least 1, and each of --sizes at least 100 faces.")
    if arguments.base is not None:
        with one_thread_by_default(), checked_out(arguments.base) as base:
            runs = versions.compare(base, max(arguments.sizes), arguments.runs)
        print(versions.render(runs), versions.render_memory(runs), sep="\n\n")
        for name in ("before", "one thread") if arguments.lines else ():
            print(f"\n{name}", versions.render_lines(runs[name], arguments.lines), sep="\n")
        return
    if arguments.hard:
        with one_thread_by_default():
            pairs = [
                (cost_of(*hard, arguments.runs), cost_of(*smooth, arguments.runs)) for hard, smooth in hard_and_smooth()
            ]
        print(render_hard(pairs))
        return
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
    header = ["mesh", "faces", *STAGES, "total s", "us/face", "MB", "bytes/face", "silence s"]
    rows = [
        [
            cost.name,
            str(cost.faces),
            *(number(cost.stage_s[stage], 3) for stage in STAGES),
            number(cost.total_s, 3),
            number(1e6 * cost.total_s / cost.faces, 2),
            number(cost.memory_bytes / 1e6, 0),
            number(cost.memory_bytes / cost.faces, 0),
            number(cost.silence_s, 2),
        ]
        for cost in costs
    ]
    return format_table(header, rows)


def render_hard(pairs: Sequence[tuple[Cost, Cost]]) -> str:
    """Return a line for every hard mesh, with the ratio of its time to that of a smooth one of its size."""
    header = ["mesh", "faces", "total s", "smooth s", "ratio", "MB", "smooth MB", "silence s"]
    rows = [
        [
            hard.name,
            str(hard.faces),
            number(hard.total_s, 2),
            number(smooth.total_s, 2),
            number(hard.total_s / smooth.total_s, 2),
            number(hard.memory_bytes / 1e6, 0),
            number(smooth.memory_bytes / 1e6, 0),
            number(hard.silence_s, 2),
        ]
        for hard, smooth in pairs
    ]
    return format_table(header, rows)


def render_crowds(costs: Sequence[Cost]) -> str:
    """Return a line for every mesh, with the ratio of its time to that of the first one."""
    rows = [
        [cost.name, str(cost.faces), number(cost.total_s, 3), number(cost.total_s / costs[0].total_s, 2)]
        for cost in costs
    ]
    return format_table(["mesh", "faces", "total s", "ratio"], rows)
