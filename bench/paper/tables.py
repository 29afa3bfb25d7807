"""The tables of the paper's evaluation as text."""

from __future__ import annotations

import math
import statistics
from collections.abc import Sequence

from bench.paper.evaluation import MethodResults
from bench.princeton.comparison import paired_difference
from bench.princeton.report import HEADINGS
from bench.princeton.summary import by_category, overall, standard_error
from bench.text import format_table, number

# Mean seconds per model in Table 2 of the paper, on a 3 GHz processor, by the keys of the methods in this package.
PAPER_SECONDS = {"inverse_power": 69.0, "split_bregman": 52.0, "fiedler": 8.7}
LOWER_IS_BETTER = "Means over models of equal weight, each compared with all of its people. Lower is better."


def metric_table(results: Sequence[MethodResults]) -> str:
    """Return all metrics of all methods and of the people, and notes on what the means leave out."""
    header = ["method", *HEADINGS.values(), "s.e. 1-Rand", "segments", "fewer", "failed"]
    rows = [_metric_row(one) for one in results]
    rows.append(["People, leave-one-out", *_cells(overall(results[0].models).people_scores)])
    notes = [
        LOWER_IS_BETTER,
        "fewer: models with fewer segments than given; failed: models on which it failed, counted as one segment.",
        *(_undefined(one) for one in results if _undefined_models(one)),
        *(failure for one in results for failure in _failures(one)),
    ]
    return "\n".join([format_table(header, rows, rules=(len(rows) - 1,)), "", *notes])


def difference_table(pairs: Sequence[tuple[MethodResults, MethodResults]]) -> str:
    """Return the differences in 1-Rand of pairs of methods (A, B) on the same models, with their standard errors."""
    header = ["B against A, 1-Rand", "A", "B", "B - A", "std. error", "B better", "B worse"]
    rows = []
    for a, b in pairs:
        paired = paired_difference(*([model.scores.one_minus_rand for model in one.models] for one in (a, b)))
        values = [paired.mean_a, paired.mean_b, paired.difference, paired.standard_error]
        title = f"{b.method.title} against {a.method.title}"
        rows.append([title, *map(number, values), str(paired.better), str(paired.worse)])
    return format_table(header, rows)


def rank_table(results: Sequence[MethodResults]) -> str:
    """Table 1: the rank of every method by its mean 1-Rand in every category, and that mean."""
    columns = [[*by_category(one.models), overall(one.models)] for one in results]
    rows = []
    for summaries in zip(*columns, strict=True):
        values = [summary.scores.one_minus_rand for summary in summaries]
        cells = [f"{rank}  {value:.3f}" for rank, value in zip(ranks(values), values, strict=True)]
        people = f"{summaries[0].people_scores.one_minus_rand:.3f}"
        rows.append([summaries[0].category, str(summaries[0].models), *cells, people])
    header = ["category", "models", *(one.method.title for one in results), "people"]
    note = "Rank by 1-Rand (1 is the best), then 1-Rand itself, all with the number of segments given."
    return "\n".join([format_table(header, rows, rules=(len(rows) - 1,)), "", note])


def ranks(values: Sequence[float]) -> list[int]:
    """Return 1 + the number of smaller values: equal values share the better rank."""
    return [1 + sum(other < value for other in values) for value in values]


def time_table(results: Sequence[MethodResults]) -> str:
    """Table 2: CPU seconds per model in one thread, and those of the paper.

    The ratios are to the first method of the paper, ``inverse_power``, in both columns.
    """
    unit = next((statistics.fmean(one.cpu_s) for one in results if one.method.key == "inverse_power"), math.nan)
    paper_unit = PAPER_SECONDS["inverse_power"]
    rows = []
    for one in results:
        seconds = one.cpu_s or [math.nan]
        mean, median = statistics.fmean(seconds), statistics.median(seconds)
        paper = PAPER_SECONDS.get(one.method.key, math.nan)
        ratios = [number(mean / unit, 3), number(paper, 1), number(paper / paper_unit, 3), number(paper / mean, 1)]
        rows.append([one.method.title, number(mean, 3), number(median, 3), *ratios])
    header = ["method", "mean s", "median s", "ratio", "paper s", "paper ratio", "paper s / mean s"]
    faces = statistics.fmean(model.faces for model in results[0].models)
    notes = [
        "CPU seconds per model in one thread, for the segmentation alone, with the number of segments given (Cleave "
        "computes its whole hierarchy).",
        "ratio: to p = 1 by inverse power. The times of the paper are for a 3 GHz processor. Mean number of faces: "
        f"{faces:.0f} (the paper: 20444).",
    ]
    return "\n".join([format_table(header, rows), "", *notes])


def _metric_row(one: MethodResults) -> list[str]:
    summary = overall(one.models)
    error = standard_error([model.scores for model in one.models]).one_minus_rand
    fewer = sum(run.fell_short for model in one.models for run in model.runs)
    counts = [number(summary.segments, 1), str(fewer), str(len(one.failures))]
    return [one.method.title, *_cells(summary.scores), number(error), *counts]


def _cells(scores: object) -> list[str]:
    return [number(getattr(scores, metric)) for metric in HEADINGS]


def _undefined_models(one: MethodResults) -> int:
    return sum(math.isnan(model.scores.cut_discrepancy) for model in one.models)


def _undefined(one: MethodResults) -> str:
    return (
        f"{one.method.title}: the cut discrepancy leaves out {_undefined_models(one)} of {len(one.models)} models, "
        "in which there is no cut."
    )


def _failures(one: MethodResults) -> list[str]:
    return [f"{one.method.title} failed on model {model}: {reason}" for model, reason in one.failures.items()]
