"""Logistic regression with fractional targets, by Newton's method."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from segcore.learned.logistic import LogisticModel, basis

if TYPE_CHECKING:
    from segcore.arrays import FloatArray

_STEPS = 30
_SETTLED = 1e-7  # decrease of the cost
_DIGITS = 5  # significant digits of the numbers in a model: what is beyond them depends on the order of additions


def fit(
    names: tuple[str, ...], features: FloatArray, target: FloatArray, weight: FloatArray, ridge: float
) -> LogisticModel:
    """Minimise the mean cross-entropy plus ridge / 2 |w|^2.

    Parameters
    ----------
    features : (N, M).
    target : (N,) in 0..1.
    weight : (N,) what every row counts for.

    Returns
    -------
    The model, its numbers rounded to five significant digits, so that every machine writes the same.
    """
    weight = weight / weight.sum()
    mean = _rounded(np.einsum("i,ij->j", weight, features))
    deviation = np.sqrt(np.einsum("i,ij->j", weight, (features - mean) ** 2))
    scale = _rounded(np.maximum(deviation, 1e-6))
    columns = basis((features - mean) / scale)
    columns = np.concatenate([columns, np.ones((len(columns), 1))], axis=1)
    penalty = np.full(columns.shape[1], ridge)
    penalty[-1] = 0.0
    solution = np.zeros(columns.shape[1])
    share = np.clip(np.dot(weight, target), 1e-6, 1 - 1e-6)
    solution[-1] = np.log(share / (1 - share))
    cost = _cost(columns, target, weight, penalty, solution)
    for _ in range(_STEPS):
        chance = _logistic(columns @ solution)
        slope = columns.T @ (weight * (chance - target)) + penalty * solution
        bend = (columns * (weight * chance * (1.0 - chance))[:, None]).T @ columns
        step = np.linalg.solve(bend + np.diag(penalty + 1e-9), slope)
        before = cost
        while (cost := _cost(columns, target, weight, penalty, solution - step)) > before:
            step *= 0.5  # far from the minimum the parabola misleads
        solution -= step
        if before - cost < _SETTLED:
            break
    rounded = _rounded(solution)
    return LogisticModel(names, mean, scale, rounded[:-1], float(rounded[-1]))


def _logistic(score: FloatArray) -> FloatArray:
    return 1.0 / (1.0 + np.exp(-np.clip(score, -500, 500)))


def _cost(columns: FloatArray, target: FloatArray, weight: FloatArray, penalty: FloatArray, x: FloatArray) -> float:
    score = columns @ x
    return float(np.dot(weight, np.logaddexp(0.0, score) - target * score) + 0.5 * np.dot(penalty, x * x))


def _rounded(values: FloatArray) -> FloatArray:
    return np.array([float(f"{value:.{_DIGITS - 1}e}") for value in values])
