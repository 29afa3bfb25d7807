"""The difference between two results of princeton --output, model by model, with its standard error.

Pairing takes the models' own difficulty out of the difference: it resolves far smaller changes than the standard errors
of the two means would.
"""

from __future__ import annotations

import argparse
import math
import statistics
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from bench.errors import BenchmarkError
from bench.princeton.metrics import METRICS
from bench.princeton.results import SavedResults, load_results
from bench.princeton.summary import standard_error_of_mean
from bench.text import format_table, number


@dataclass(frozen=True, slots=True)
class PairedDifference:
    """B against A in one metric, over the models where both are defined."""

    models: int
    mean_a: float
    mean_b: float
    difference: float  # mean of B - A
    standard_error: float  # of the difference; nan below two models
    better: int  # models where B is lower
    worse: int


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("a", type=Path, metavar="A.json", help="the results to start from")
    parser.add_argument("b", type=Path, metavar="B.json", help="the results to compare with them")


def run(arguments: argparse.Namespace) -> None:
    a, b = load_results(arguments.a), load_results(arguments.b)
    print(render(a, b))


def paired_difference(a: Sequence[float], b: Sequence[float]) -> PairedDifference:
    """Compare two sequences of values of the same models; pairs with a nan are left out."""
    pairs = [(x, y) for x, y in zip(a, b, strict=True) if not math.isnan(x) and not math.isnan(y)]
    differences = [y - x for x, y in pairs]
    return PairedDifference(
        models=len(pairs),
        mean_a=_mean([x for x, _ in pairs]),
        mean_b=_mean([y for _, y in pairs]),
        difference=_mean(differences),
        standard_error=standard_error_of_mean(differences),
        better=sum(difference < 0 for difference in differences),
        worse=sum(difference > 0 for difference in differences),
    )


def render(a: SavedResults, b: SavedResults) -> str:
    """The table of all metrics over the models that both results have.

    Raises
    ------
    BenchmarkError
        Where they have no model in common.
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
            f"{len(b.scores) - len(common)} only in B. Lower is better: a negative difference is in favour of B.",
            "",
            format_table(header, rows),
        ]
    )


def _row(metric: str, a: Sequence[float], b: Sequence[float]) -> list[str]:
    paired = paired_difference(a, b)
    values = [paired.mean_a, paired.mean_b, paired.difference, paired.standard_error]
    return [metric, str(paired.models), *map(number, values), str(paired.better), str(paired.worse)]


def _mean(values: Sequence[float]) -> float:
    return statistics.fmean(values) if values else math.nan
