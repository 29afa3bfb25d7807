"""Logistic regression with fractional targets, by Newton's method."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from segcore.learned.logistic import LogisticModel, basis

if TYPE_CHECKING:
    from bench.learning.rows import Rows
    from segcore.arrays import FloatArray

_STEPS = 30  # a limit, in case the cost does not settle
_SETTLED = 1e-7  # decrease of the cost that ends the iteration; set by hand
_DIGITS = 5  # significant digits of the numbers in a model: further ones depend on the order of additions
# Guards against log(0) and divisions by zero, far below the values of real data.
LEAST_SCALE = 1e-6
_LEAST_CHANCE = 1e-6
_LEAST_CURVATURE = 1e-9


class _Problem(NamedTuple):
    """Minimise mean cross-entropy + sum of penalty x^2 / 2 over x."""

    columns: FloatArray  # (N, K)
    target: FloatArray  # (N,)
    weight: FloatArray  # (N,) sum 1
    penalty: FloatArray  # (K,)

    def cost(self, x: FloatArray) -> float:
        score = self.columns @ x
        entropy = np.logaddexp(0.0, score) - self.target * score
        return float(np.dot(self.weight, entropy) + 0.5 * np.dot(self.penalty, x * x))

    def newton_step(self, x: FloatArray) -> FloatArray:
        chance = _logistic(self.columns @ x)
        gradient = self.columns.T @ (self.weight * (chance - self.target)) + self.penalty * x
        hessian = (self.columns * (self.weight * chance * (1.0 - chance))[:, None]).T @ self.columns
        step = np.linalg.solve(hessian + np.diag(self.penalty + _LEAST_CURVATURE), gradient)
        return step.astype(np.float64, copy=False)


def fit(names: tuple[str, ...], rows: Rows, ridge: float) -> LogisticModel:
    """Minimise the weighted mean cross-entropy + ridge / 2 |w|^2.

    Parameters
    ----------
    names : of the M features of the rows.

    Returns
    -------
    The model, its numbers rounded to five significant digits so that they are the same on every machine.
    """
    weight = rows.weight / rows.weight.sum()
    mean, scale = mean_and_scale(rows.features, weight)
    columns = basis((rows.features - mean) / scale)
    columns = np.concatenate([columns, np.ones((len(columns), 1))], axis=1)
    penalty = np.full(columns.shape[1], ridge)
    penalty[-1] = 0.0
    solution = rounded(_minimise(_Problem(columns, rows.target, weight, penalty)))
    return LogisticModel(names, mean, scale, solution[:-1], float(solution[-1]))


def mean_and_scale(features: FloatArray, weight: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(M,) weighted means of features (N, M), and their standard deviations, both rounded; the weights sum to 1."""
    mean = rounded(np.einsum("i,ij->j", weight, features))
    deviation = np.sqrt(np.einsum("i,ij->j", weight, (features - mean) ** 2))
    return mean, rounded(np.maximum(deviation, LEAST_SCALE))


def _minimise(problem: _Problem) -> FloatArray:
    """(K,) minimum, by Newton's method with halved steps, from the model that returns the mean target."""
    x = np.zeros(len(problem.penalty))
    share = np.clip(np.dot(problem.weight, problem.target), _LEAST_CHANCE, 1 - _LEAST_CHANCE)
    x[-1] = np.log(share / (1 - share))
    cost = problem.cost(x)
    for _ in range(_STEPS):
        step = problem.newton_step(x)
        before = cost
        while (cost := problem.cost(x - step)) > before:
            step *= 0.5  # the quadratic model is not accurate far from the minimum
        x -= step
        if before - cost < _SETTLED:
            break
    return x


def _logistic(score: FloatArray) -> FloatArray:
    return 1.0 / (1.0 + np.exp(-np.clip(score, -500, 500)))  # exp(710) is infinite


def rounded(values: FloatArray) -> FloatArray:
    """Return numbers with five significant digits, which are the same on every machine."""
    return np.array([float(f"{value:.{_DIGITS - 1}e}") for value in values])
