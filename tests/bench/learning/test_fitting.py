"""Logistic regression."""

import numpy as np

from bench.learning.fitting import fit
from bench.learning.rows import Rows
from segcore.learned.logistic import basis


def test_fitting_finds_the_model_of_the_data() -> None:
    rng = np.random.default_rng(0)
    features = rng.normal(size=(20_000, 2))
    target = 1 / (1 + np.exp(-(2 * features[:, 0] - features[:, 1] - 1)))
    model = fit(("a", "b"), Rows(features, target, np.ones(len(target))), ridge=1e-6)
    np.testing.assert_allclose(model.probability(features), target, atol=0.02)
    assert basis(features).shape == (20_000, 8)
