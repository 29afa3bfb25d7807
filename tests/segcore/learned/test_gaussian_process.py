import json
from dataclasses import replace

import numpy as np

from segcore.learned.gaussian_process import GaussianProcess, quantised, similarities
from segcore.learned.logistic import LogisticModel


def process(weight=(0.2, -0.3)):
    """Two centres in the plane of the features a and b; the trend depends on b alone."""
    trend = LogisticModel(("b",), np.zeros(1), np.ones(1), np.array([1.0, 0.0, 0.0, 0.0]), 0.0)
    centres = quantised(np.array([[0.0, 0.0], [2.0, 0.0]]))
    return GaussianProcess(
        ("a", "b"), np.array([1.0, 0.0]), np.array([0.5, 1.0]), 2.0, centres, np.array(weight), trend
    )


def test_the_estimate_is_the_trend_and_a_sum_over_the_centres():
    a, b = 1.25, 0.5
    z = np.array([(a - 1.0) / 0.5, b])
    distance = np.linalg.norm(z - np.array([[0.0, 0.0], [2.0, 0.0]]), axis=1) / 2.0
    expected = 1 / (1 + np.exp(-b)) + np.array([0.2, -0.3]) @ np.exp(-0.5 * distance**2)
    np.testing.assert_allclose(process().estimate(np.array([[a, b]])), expected, atol=2e-3)  # centres are rounded


def test_far_from_all_centres_the_estimate_is_the_trend():
    far = replace(process(), length=0.2)
    rows = np.array([[3.0, -1.0], [-1.0, 2.0]])
    np.testing.assert_allclose(far.estimate(rows), far.trend.probability(rows[:, 1:]), atol=1e-9)


def test_estimates_are_shares_whatever_the_row():
    rows = np.array([[1.0, 0.0], [2.0, 0.0], [1e30, -1e30]])
    for weight in ((5.0, 5.0), (-5.0, -5.0)):
        estimate = process(weight).estimate(rows)
        assert ((estimate >= 0.0) & (estimate <= 1.0)).all()


def test_centres_are_kept_within_a_sixtieth_of_a_standard_deviation_and_clipped_at_four():
    values = np.array([[0.3, -1.7], [9.0, -9.0]])
    centres = replace(process(), centres=quantised(values), length=1.0).scaled_centres()
    np.testing.assert_allclose(centres, np.clip(values, -4.0, 4.0), atol=1 / 60)


def test_a_document_contains_the_whole_process():
    again = GaussianProcess.from_document(json.loads(json.dumps(process().document())))
    rows = np.random.default_rng(0).normal(size=(20, 2))
    np.testing.assert_array_equal(again.estimate(rows), process().estimate(rows))
    assert again.document() == process().document()


def test_the_kernel_is_compiled_once_whatever_the_order_of_the_rows_in_memory():
    rows = np.random.default_rng(0).normal(size=(3, 2))
    for given in (rows, np.asfortranarray(rows), rows[:1], np.asfortranarray(rows)[:1]):
        process().estimate(given)
    assert len(similarities.signatures) == 1


def test_no_rows_have_no_estimates():
    assert process().estimate(np.empty((0, 2))).shape == (0,)
