"""Means of scores over models: by category, over all models, and over the categories."""

from __future__ import annotations

import math
import statistics
from collections.abc import Sequence
from dataclasses import dataclass

from bench.princeton.evaluation import ModelResult
from bench.princeton.metrics import METRICS, Scores, mean_scores


@dataclass(frozen=True, slots=True)
class CategorySummary:
    """Means over the models of one category."""

    category: str
    models: int
    scores: Scores
    people_scores: Scores
    segments: float  # mean over models and seeds
    given_segments: float


def by_category(results: Sequence[ModelResult]) -> list[CategorySummary]:
    """Return one summary per category, in the order of their first appearance."""
    categories = dict.fromkeys(result.category for result in results)
    return [_summary(name, [result for result in results if result.category == name]) for name in categories]


def overall(results: Sequence[ModelResult]) -> CategorySummary:
    """Return the summary of all models, each with the same weight."""
    return _summary("All models", results)


def mean_of_categories(results: Sequence[ModelResult]) -> Scores:
    """Return the mean over the categories, each with the same weight."""
    return mean_scores([summary.scores for summary in by_category(results)])


def standard_error(scores: Sequence[Scores]) -> Scores:
    """Return the standard error of the mean over models for every metric; nan below two models."""
    return Scores(**{metric: standard_error_of_mean([getattr(s, metric) for s in scores]) for metric in METRICS})


def standard_error_of_mean(values: Sequence[float]) -> float:
    """Sample standard deviation / sqrt(count) of the values that are not nan; nan below two of them."""
    defined = [value for value in values if not math.isnan(value)]
    return statistics.stdev(defined) / math.sqrt(len(defined)) if len(defined) > 1 else math.nan


def scores_by_seed(results: Sequence[ModelResult]) -> dict[int, Scores]:
    """Return the mean over all models for each seed."""
    runs = [run for result in results for run in result.runs]
    seeds = dict.fromkeys(run.seed for run in runs)
    return {seed: mean_scores([run.scores for run in runs if run.seed == seed]) for seed in seeds}


def _summary(category: str, results: Sequence[ModelResult]) -> CategorySummary:
    return CategorySummary(
        category=category,
        models=len(results),
        scores=mean_scores([result.scores for result in results]),
        people_scores=mean_scores([result.people_scores for result in results]),
        segments=statistics.fmean(run.segments for result in results for run in result.runs),
        given_segments=statistics.fmean(result.given_segments for result in results),
    )
