"""Constants that were fitted or set by hand beside their neighbours: one is changed at a time.

With --data, the constants of rules and boundaries are judged by 1-Rand on the Princeton benchmark, seed 0, with the
number of segments given and with the automatic number, by the models that ship. With --references, the constants of
solvers are judged by their normalized Cheeger cuts, relative to the best known ones, and by CPU milliseconds per graph.
A star marks the value in force.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from statistics import mean
from typing import TYPE_CHECKING

from bench.arguments import add_jobs, require_jobs
from bench.constants.catalogue import OF_SEGMENTATIONS, OF_SOLVERS, Constant
from bench.errors import BenchmarkError
from bench.pool import map_in_processes
from bench.princeton.dataset import read_models
from bench.text import format_table, number

if TYPE_CHECKING:
    from bench.constants.evaluation import CutQuality, Quality


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--data", type=Path, metavar="DIR", help="the folder of the Princeton benchmark")
    parser.add_argument("--references", type=Path, metavar="DIR", help="the folder of the reference graphs")
    parser.add_argument("--limit", type=int, metavar="N", help="only N models, spread evenly over the list")
    add_jobs(parser)
    parser.add_argument("--only", nargs="+", metavar="NAME", help="only the constants of these names")


def run(arguments: argparse.Namespace) -> None:
    if arguments.data is None and arguments.references is None:
        raise BenchmarkError("There is nothing to measure: give --data, --references or both.")
    require_jobs(arguments.jobs)
    names = {constant.name for constant in (*OF_SEGMENTATIONS, *OF_SOLVERS)}
    unknown = set(arguments.only or ()) - names
    if unknown:
        raise BenchmarkError(f"There is no constant {min(unknown)!r}; the constants are {', '.join(sorted(names))}.")
    chosen = names if arguments.only is None else set(arguments.only)
    if arguments.data is not None:
        _measure_segmentations(arguments, [constant for constant in OF_SEGMENTATIONS if constant.name in chosen])
    if arguments.references is not None:
        _measure_solvers(arguments.references, [constant for constant in OF_SOLVERS if constant.name in chosen])


def _measure_segmentations(arguments: argparse.Namespace, constants: Sequence[Constant]) -> None:
    # Imported here so that listing commands does not load the compiled kernels.
    from bench.constants.evaluation import quality
    from segcore import warm_up

    models = read_models(arguments.data, arguments.limit)
    for constant in constants:
        measured = [
            map_in_processes(partial(quality, constant, value), models, arguments.jobs, warm_up)
            for value in constant.values
        ]
        print(render_qualities(constant, measured), flush=True)


def _measure_solvers(folder: Path, constants: Sequence[Constant]) -> None:
    from bench.cheeger.measurements import warm_up
    from bench.cheeger.references import read_references
    from bench.constants.evaluation import cut_quality

    references = read_references(folder)
    graphs, best_known = [one.graph for one in references], [one.best_known for one in references]
    warm_up(sorted({constant.solver for constant in constants}))
    for constant in constants:
        measured = [cut_quality(constant, value, graphs, best_known) for value in constant.values]
        print(render_cuts(constant, measured), flush=True)


def render_qualities(constant: Constant, measured: Sequence[Sequence[Quality]]) -> str:
    """Return a table with a row for every value; the standard error is of the difference from the value in force."""
    in_force = measured[constant.values.index(constant.value)]
    rows = [
        [
            _value(constant, value),
            number(mean(one.given for one in models)),
            number(_error([one.given - other.given for one, other in zip(models, in_force, strict=True)])),
            number(mean(one.automatic for one in models)),
            number(_error([one.automatic - other.automatic for one, other in zip(models, in_force, strict=True)])),
        ]
        for value, models in zip(constant.values, measured, strict=True)
    ]
    chosen = "".join(f", {name} = {value}" for name, value in constant.parameters.items())
    title = f"{constant.name} ({len(in_force)} models{chosen})"
    return format_table([title, "given: 1-Rand", "s.e.", "automatic: 1-Rand", "s.e."], rows) + "\n"


def render_cuts(constant: Constant, measured: Sequence[CutQuality]) -> str:
    """Return a table with a row for every value."""
    rows = [
        [_value(constant, value), number(one.ratio), number(one.worst), number(1e3 * one.cpu_s, 1)]
        for value, one in zip(constant.values, measured, strict=True)
    ]
    return format_table([f"{constant.name} ({constant.solver})", "cut", "worst", "ms"], rows) + "\n"


def _value(constant: Constant, value: float) -> str:
    return f"{value:g}{' *' if value == constant.value else ''}"


def _error(differences: Sequence[float]) -> float:
    """The standard error of the mean of differences."""
    count = len(differences)
    if count < 2:
        return float("nan")
    centre = mean(differences)
    return float((sum((difference - centre) ** 2 for difference in differences) / (count - 1) / count) ** 0.5)
