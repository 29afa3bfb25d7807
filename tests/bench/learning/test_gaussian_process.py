"""The Gaussian process that estimates the splits of a tree once more."""

from dataclasses import replace

import numpy as np

from bench.learning.gaussian_process import CENTRES, fit_gaussian_process
from bench.learning.rows import Rows
from segcore.cut.rules import ORDER_FEATURES
from segcore.learned.gaussian_process import GaussianProcess, similarities


def rows(count: int) -> Rows:
    """The target is high where the signs of two features agree, which no logistic function of one feature is."""
    rng = np.random.default_rng(0)
    features = np.zeros((count, len(ORDER_FEATURES)))
    features[:, [0, 7, 8]] = rng.normal(size=(count, 3))
    target = np.where(features[:, 7] * features[:, 8] > 0.0, 0.9, 0.1)
    return Rows(features, target, rng.uniform(0.5, 1.0, count))


def fitted(table: Rows) -> GaussianProcess:
    process = fit_gaussian_process(table)
    assert process is not None
    return process


def test_the_process_learns_what_the_trend_cannot() -> None:
    process = fitted(rows(2000))
    assert process.names == ORDER_FEATURES
    assert process.centres.shape == (CENTRES, len(ORDER_FEATURES))
    table = rows(2500)
    estimate, trend = process.estimate(table.features), np.average(table.target)
    assert np.abs(estimate - table.target).mean() < 0.7 * np.abs(trend - table.target).mean()


def test_the_same_rows_give_the_same_process() -> None:
    one, other = fitted(rows(500)), fitted(rows(500))
    assert one.document() == other.document()


def test_with_a_centre_at_every_row_it_is_the_posterior_mean() -> None:
    """Rasmussen and Williams 2006, equation 2.25, with a noise of 0.3 over the weight of each row."""
    table = rows(300)
    process = fitted(table)
    left = table.target - replace(process, weight=np.zeros(300)).estimate(table.features)
    covariance = similarities(process.scaled(table.features), process.scaled(table.features))
    noise = np.diag(0.3 * table.weight.mean() / table.weight)
    mean = table.target - left + covariance @ np.linalg.solve(covariance + noise, left)
    np.testing.assert_allclose(process.estimate(table.features), np.clip(mean, 0.0, 1.0), atol=0.02)


def test_no_rows_give_no_process() -> None:
    assert fit_gaussian_process(rows(0)) is None
