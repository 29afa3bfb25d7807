"""The forest that orders the splits of a tree."""

import numpy as np

from bench.learning.forests import MOST_LEAVES, TREES, grow_forest
from bench.learning.rows import Rows
from segcore.cut.rules import ORDER_FEATURES


def rows(count: int) -> Rows:
    rng = np.random.default_rng(0)
    features = rng.normal(size=(count, len(ORDER_FEATURES)))
    target = np.where(features[:, 0] > 0.0, np.where(features[:, 3] > 0.5, 0.9, 0.6), 0.1)
    return Rows(features, target, rng.uniform(0.5, 1.0, count))


def test_the_forest_has_the_means_of_the_trees_that_were_fitted() -> None:
    from sklearn.ensemble import ExtraTreesRegressor

    table = rows(4000)
    forest = grow_forest(table)
    assert forest is not None
    assert forest.names == ORDER_FEATURES
    assert forest.nodes.shape == (TREES, 2 * MOST_LEAVES - 1)
    fitted = ExtraTreesRegressor(
        TREES, min_samples_leaf=3, max_features=0.4, max_leaf_nodes=MOST_LEAVES, random_state=0
    ).fit(table.features, table.target, sample_weight=table.weight)
    np.testing.assert_allclose(forest.mean(table.features), fitted.predict(table.features), atol=1e-6)
    assert np.abs(forest.mean(table.features) - table.target).mean() < 0.1


def test_no_rows_give_no_forest() -> None:
    assert grow_forest(rows(0)) is None
