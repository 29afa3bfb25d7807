"""The Gaussian process that estimates the splits of a tree once more."""

from dataclasses import replace

import numpy as np

from bench.learning.gaussian_process import centres, fit_gaussian_process
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
    assert process.centres.shape == (len(process.weight), len(ORDER_FEATURES))
    table = rows(2500)
    estimate, trend = process.estimate(table.features), np.average(table.target)
    assert np.abs(estimate - table.target).mean() < 0.7 * np.abs(trend - table.target).mean()


def test_centres_stand_for_all_rows() -> None:
    """The covariance of all points is that through the centres, although most points are no centres."""
    points = np.random.default_rng(0).normal(size=(400, 2)) / 3.0
    chosen = centres(points, np.ones(400), 400)
    assert len(chosen) == len(set(chosen.tolist())) < 60
    all_points, between = similarities(points, points), similarities(points, points[chosen])
    through = between @ np.linalg.solve(between[chosen], between.T)
    np.testing.assert_allclose(through, all_points, atol=1e-4)


def test_the_first_centres_are_where_the_weight_is() -> None:
    points = np.concatenate([np.zeros((5, 2)), np.full((5, 2), 9.0), np.full((5, 2), -9.0)])
    assert centres(points, np.repeat([1.0, 3.0, 2.0], 5), 2).tolist() == [5, 10]
    assert len(centres(points, np.repeat([1.0, 3.0, 0.0], 5), 10)) == 2  # a row without weight is no centre


def test_the_same_rows_give_the_same_process() -> None:
    one, other = fitted(rows(500)), fitted(rows(500))
    assert one.document() == other.document()


def test_with_enough_centres_it_is_the_posterior_mean() -> None:
    """Rasmussen and Williams 2006, equation 2.25, with a noise of 0.5 over the weight of each row."""
    table = rows(300)
    process = fitted(table)
    left = table.target - replace(process, weight=np.zeros(len(process.weight))).estimate(table.features)
    covariance = similarities(process.scaled(table.features), process.scaled(table.features))
    noise = np.diag(0.5 * table.weight.mean() / table.weight)
    mean = table.target - left + covariance @ np.linalg.solve(covariance + noise, left)
    np.testing.assert_allclose(process.estimate(table.features), np.clip(mean, 0.0, 1.0), atol=0.01)


def test_no_rows_give_no_process() -> None:
    assert fit_gaussian_process(rows(0)) is None
