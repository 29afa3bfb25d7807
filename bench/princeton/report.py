"""The printed report of a run of the Princeton benchmark."""

from __future__ import annotations

import math
import os
import platform
import statistics
from collections.abc import Sequence

from bench.princeton.evaluation import ModelResult, Run, SegmentChoice
from bench.princeton.metrics import METRICS, Scores
from bench.princeton.summary import by_category, mean_of_categories, overall, scores_by_seed, standard_error
from bench.text import format_table, number

HEADINGS = {
    "cut_discrepancy": "cut discr.",
    "hamming": "Hamming",
    "missing_rate": "missing",
    "false_alarm_rate": "false al.",
    "one_minus_rand": "1-Rand",
    "gce": "GCE",
    "lce": "LCE",
}
# The largest difference at which an automatic number of segments counts as close to the given one; set by hand.
NEAR_SEGMENTS = 2
WEIGHTING = (
    "Every score is the mean over the people of a model and over the seeds, then over models of equal weight.\n"
    "Lower is better."
)


def render(results: Sequence[ModelResult], choice: SegmentChoice) -> str:
    """Return the table and the lines below it as text."""
    people = sum(result.people for result in results)
    seeds = ", ".join(str(run.seed) for run in results[0].runs)
    title = (
        f"Princeton Segmentation Benchmark: {len(results)} models, {people} segmentations by people, "
        f"number of segments {choice}, seeds {seeds}."
    )
    return "\n".join([title, WEIGHTING, "", _score_table(results), "", *_facts(results, choice)])


def _score_table(results: Sequence[ModelResult]) -> str:
    header = ["category", "models", *HEADINGS.values(), "segments", "given", "people 1-Rand"]
    categories = by_category(results)
    total = overall(results)
    rows = [
        [
            summary.category,
            str(summary.models),
            *_cells(summary.scores),
            number(summary.segments, 1),
            number(summary.given_segments, 1),
            number(summary.people_scores.one_minus_rand),
        ]
        for summary in [*categories, total]
    ]
    rows.append(["  standard error", "", *_cells(standard_error([result.scores for result in results]))])
    means = mean_of_categories(results)
    if _differ(means, total.scores):
        rows.append(["Mean of categories", str(len(categories)), *_cells(means)])
    rows.append(["People, leave-one-out", str(total.models), *_cells(total.people_scores)])
    return format_table(header, rows, rules=(len(categories), len(rows) - 1))


def _cells(scores: Scores) -> list[str]:
    return [number(getattr(scores, metric)) for metric in HEADINGS]


def _differ(some: Scores, other: Scores) -> bool:
    """Return True if two rows are printed differently."""
    return any(number(getattr(some, metric)) != number(getattr(other, metric)) for metric in METRICS)


def _facts(results: Sequence[ModelResult], choice: SegmentChoice) -> list[str]:
    runs = [run for result in results for run in result.runs]
    facts = [_segment_fact(results, runs, choice), *_undefined_fact(results, runs), *_seed_fact(results)]
    return [*facts, _cpu_fact(runs)]


def _segment_fact(results: Sequence[ModelResult], runs: Sequence[Run], choice: SegmentChoice) -> str:
    if choice == "given":
        short = sum(run.fell_short for run in runs)
        return f"Fewer segments than given, because the hierarchy ends earlier: {short} of {len(runs)} segmentations."
    near = sum(abs(run.segments - r.given_segments) <= NEAR_SEGMENTS for r in results for run in r.runs)
    mean = statistics.fmean(run.segments for run in runs)
    given = statistics.fmean(result.given_segments for result in results)
    return (
        f"Automatic number of segments: mean {mean:.1f} (given: {given:.1f}); within {NEAR_SEGMENTS} of the given one "
        f"in {near} of {len(runs)} segmentations ({near / len(runs):.0%})."
    )


def _undefined_fact(results: Sequence[ModelResult], runs: Sequence[Run]) -> list[str]:
    undefined = sum(run.undefined_cut_discrepancies for run in runs)
    if undefined == 0:
        return []
    comparisons = sum(result.people * len(result.runs) for result in results)
    lost = sum(math.isnan(result.scores.cut_discrepancy) for result in results)
    return [
        f"Cut discrepancy is undefined if one of two segmentations has no cut: {undefined} of {comparisons} "
        f"comparisons are left out of it, and with them {lost} of {len(results)} models."
    ]


def _seed_fact(results: Sequence[ModelResult]) -> list[str]:
    by_seed = {seed: scores.one_minus_rand for seed, scores in scores_by_seed(results).items()}
    if len(by_seed) < 2:
        return []
    values = ", ".join(f"{seed}: {value:.4f}" for seed, value in by_seed.items())
    return [f"1-Rand by seed: {values}; standard deviation {statistics.stdev(by_seed.values()):.4f}."]


def _cpu_fact(runs: Sequence[Run]) -> str:
    seconds = [run.cpu_s for run in runs]
    return (
        f"CPU seconds per mesh for the segmentation alone, on this machine only ({platform.machine()}, "
        f"{os.cpu_count()} CPUs): mean {statistics.fmean(seconds):.2f}, median {statistics.median(seconds):.2f}."
    )
