"""The difference between two results of princeton --output, model by model, with its standard error.

Pairing removes the differences between models from the comparison: it resolves far smaller changes than the standard
errors of the two means.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from bench.errors import BenchmarkError
from bench.princeton.comparison import paired_difference
from bench.princeton.metrics import METRICS
from bench.princeton.results import SavedResults, load_results
from bench.text import format_table, number


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("a", type=Path, metavar="A.json", help="the first results")
    parser.add_argument("b", type=Path, metavar="B.json", help="the results to compare with them")


def run(arguments: argparse.Namespace) -> None:
    a, b = load_results(arguments.a), load_results(arguments.b)
    print(render(a, b))


def render(a: SavedResults, b: SavedResults) -> str:
    """Return the table of all metrics over the models that are in both results.

    Raises
    ------
    BenchmarkError
        If they have no model in common.
    """
    common = sorted(a.scores.keys() & b.scores.keys())
    if not common:
        raise BenchmarkError("The two results have no model in common: run princeton on the same data for both.")
    rows = [
        _row(metric, [getattr(a.scores[m], metric) for m in common], [getattr(b.scores[m], metric) for m in common])
        for metric in METRICS
    ]
    header = ["metric", "models", "A", "B", "B - A", "std. error", "B better", "B worse"]
    return "\n".join(
        [
            f"A: {a.settings}",
            f"B: {b.settings}",
            f"{len(common)} models in both, {len(a.scores) - len(common)} only in A, "
            f"{len(b.scores) - len(common)} only in B. Lower is better: B is better if the difference is negative.",
            "",
            format_table(header, rows),
        ]
    )


def _row(metric: str, a: Sequence[float], b: Sequence[float]) -> list[str]:
    paired = paired_difference(a, b)
    values = [paired.mean_a, paired.mean_b, paired.difference, paired.standard_error]
    return [metric, str(paired.models), *map(number, values), str(paired.better), str(paired.worse)]
