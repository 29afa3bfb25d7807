"""Grows the forest of regression trees that orders the splits of a finished tree."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from segcore.cut.rules import ORDER_FEATURES
from segcore.learned.forest import LEAF, NODE, Forest

if TYPE_CHECKING:
    import numpy.typing as npt
    from sklearn.tree._tree import Tree

    from bench.learning.rows import Rows

# Set by hand: more trees, or larger ones, make no difference; see bench/RESULTS.md, "Authored assets".
TREES = 100
MOST_LEAVES = 256
_LEAST_ROWS = 3  # in a leaf
_TRIED_FEATURES = 0.4  # share of the features of which a node tries a random threshold each


def grow_forest(rows: Rows, seed: int = 0) -> Forest | None:
    """Fit extremely randomized trees to the rows of ``bench.learning.splits.split_rows``; None if there are no rows."""
    from sklearn.ensemble import ExtraTreesRegressor

    if len(rows.target) == 0:
        return None
    regressor = ExtraTreesRegressor(
        TREES,
        min_samples_leaf=_LEAST_ROWS,
        max_features=_TRIED_FEATURES,
        max_leaf_nodes=MOST_LEAVES,
        random_state=seed,
    )
    regressor.fit(rows.features, rows.target, sample_weight=rows.weight)
    nodes = np.zeros((TREES, 2 * MOST_LEAVES - 1), dtype=NODE)
    nodes["feature"] = LEAF  # the rest of smaller trees is never reached
    for t, estimator in enumerate(regressor.estimators_):
        in_preorder = _in_preorder(estimator.tree_)
        nodes[t, : len(in_preorder)] = in_preorder
    return Forest(ORDER_FEATURES, nodes)


def _in_preorder(tree: Tree) -> npt.NDArray[np.void]:
    """The nodes of a tree, every node before its first child, and that before the second one."""
    nodes: list[tuple[int, int, float]] = []

    def visit(node: int) -> None:
        place = len(nodes)
        first, second = int(tree.children_left[node]), int(tree.children_right[node])
        if first < 0:
            nodes.append((LEAF, 0, float(tree.value[node].item())))
            return
        nodes.append((0, 0, 0.0))
        visit(first)
        nodes[place] = (int(tree.feature[node]), len(nodes), float(tree.threshold[node]))
        visit(second)

    visit(0)
    return np.array(nodes, dtype=NODE)
