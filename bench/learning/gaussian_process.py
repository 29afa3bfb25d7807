"""Fits the Gaussian process that estimates the splits of a finished tree once more."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from bench.learning.fitting import fit, mean_and_scale, rounded
from segcore.cut.rules import ORDER_FEATURES
from segcore.learned.gaussian_process import GaussianProcess, quantised, similarities

if TYPE_CHECKING:
    from bench.learning.rows import Rows
    from segcore.arrays import FloatArray

# Set by hand: decisions 24 and 25 compare neighbours of some.
CENTRES = 1000  # rows at which the correction of the trend is anchored
_LENGTH = 3.0  # in standard deviations of the features
_NOISE = 0.3  # variance of a target over that of the process
_JITTER = 1e-5  # makes the equations solvable if two centres are alike
_TREND = ("kept", "small_area", "large_area", "depth", "ncut", "paired")
_TREND_RIDGE = 1e-2


def fit_gaussian_process(rows: Rows, seed: int = 0) -> GaussianProcess | None:
    """Fit a logistic trend, and a Gaussian process to what it leaves, to the rows of ``split_rows``.

    The weighted sum of squares of the errors over the noise, plus the norm of the correction, is least. The centres are
    drawn by weight. None if there are no rows.
    """
    if len(rows.target) == 0:
        return None
    names = ORDER_FEATURES
    trend = fit(_TREND, rows.columns([names.index(name) for name in _TREND]), _TREND_RIDGE)
    weight = rows.weight / rows.weight.sum()
    mean, scale = mean_and_scale(rows.features, weight)
    count = min(CENTRES, int(np.count_nonzero(weight)))
    drawn = np.random.default_rng(seed).choice(len(weight), count, replace=False, p=weight)
    centres = quantised((rows.features[drawn] - mean) / scale)
    process = GaussianProcess(names, mean, scale, _LENGTH, centres, np.zeros(len(centres)), trend)
    left = rows.target - process.estimate(rows.features)
    basis = similarities(process.scaled(rows.features), process.scaled_centres())
    return replace(process, weight=_solved(basis, basis[drawn], left, len(weight) * weight))


def _solved(basis: FloatArray, between: FloatArray, left: FloatArray, weight: FloatArray) -> FloatArray:
    """(C,) weights of the centres.

    Parameters
    ----------
    basis, between : similarities of the rows (N, C) and of the centres (C, C) to the centres.
    left : (N,) what the trend leaves of the targets.
    weight : (N,) of the rows, 1 on average.
    """
    equations = (basis * weight[:, None]).T @ basis + _NOISE * between + _JITTER * np.eye(len(between))
    solution = np.linalg.solve(equations, basis.T @ (weight * left))
    return rounded(solution.astype(np.float64, copy=False))
