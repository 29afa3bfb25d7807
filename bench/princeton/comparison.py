"""Paired differences between the scores of two runs on the same models."""

from __future__ import annotations

import math
import statistics
from collections.abc import Sequence
from dataclasses import dataclass

from bench.princeton.summary import standard_error_of_mean


@dataclass(frozen=True, slots=True)
class PairedDifference:
    """B against A in one metric, over the models for which both are defined."""

    models: int
    mean_a: float
    mean_b: float
    difference: float  # mean of B - A
    standard_error: float  # of the difference; nan below two models
    better: int  # number of models with a lower B
    worse: int


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


def _mean(values: Sequence[float]) -> float:
    return statistics.fmean(values) if values else math.nan
