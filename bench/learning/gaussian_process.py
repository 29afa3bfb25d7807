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
    from segcore.arrays import FloatArray, IntArray

# Set by hand: decisions 24, 25 and 30 compare neighbours of some.
_CENTRES = 1000  # rows at which the correction of the trend is anchored
_LENGTH = 3.0  # in standard deviations of the features
_NOISE = 0.5  # variance of a target over that of the process
_JITTER = 1e-5  # makes the equations solvable if two centres are alike
_LEAST_LEFT = 1e-6  # of the weighted variance of a row that is worth a centre
_TREND = ("kept", "small_area", "large_area", "depth", "ncut", "paired")
_TREND_RIDGE = 1e-2


def fit_gaussian_process(rows: Rows) -> GaussianProcess | None:
    """Fit a logistic trend, and a Gaussian process to what it leaves, to the rows of ``split_rows``.

    The weighted sum of squares of the errors over the noise, plus the norm of the correction, is least. None if there
    are no rows.
    """
    if len(rows.target) == 0:
        return None
    names = ORDER_FEATURES
    trend = fit(_TREND, rows.columns([names.index(name) for name in _TREND]), _TREND_RIDGE)
    weight = rows.weight / rows.weight.sum()
    mean, scale = mean_and_scale(rows.features, weight)
    weight *= len(weight)
    anywhere = quantised((rows.features - mean) / scale)
    process = GaussianProcess(names, mean, scale, _LENGTH, anywhere, np.zeros(len(anywhere)), trend)
    chosen = centres(process.scaled_centres(), weight, _CENTRES)
    process = replace(process, centres=anywhere[chosen], weight=np.zeros(len(chosen)))
    left = rows.target - process.estimate(rows.features)
    basis = similarities(process.scaled(rows.features), process.scaled_centres())
    return replace(process, weight=_solved(basis, basis[chosen], left, weight))


def centres(points: FloatArray, weight: FloatArray, count: int) -> IntArray:
    """At most ``count`` of N points, which know as much as possible of the process at all of them.

    The next one is always that of the largest weighted variance, given the process at those before: the pivots of a
    Cholesky factorization of the weighted covariance. It ends early if next to nothing is left.

    Parameters
    ----------
    points : (N, M) features over the length scale.
    weight : (N,) of the points, 1 on average.

    References
    ----------
    Fine and Scheinberg, Efficient SVM training using low-rank kernel representations, Journal of Machine Learning
    Research 2, 2001.
    """
    factor = np.zeros((len(points), min(count, len(points))))
    variance = np.ones(len(points))
    chosen: list[int] = []
    for j in range(factor.shape[1]):
        pivot = int(np.argmax(variance * weight))
        if variance[pivot] * weight[pivot] < _LEAST_LEFT:
            break
        covariance = similarities(points, points[pivot : pivot + 1])[:, 0]
        factor[:, j] = (covariance - factor[:, :j] @ factor[pivot, :j]) / np.sqrt(variance[pivot])
        variance = np.maximum(variance - factor[:, j] ** 2, 0.0)
        variance[pivot] = 0.0
        chosen.append(pivot)
    return np.array(chosen)


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
