import json

import numpy as np

from segcore.learned.forest import LEAF, NODE, Forest


def stumps():
    """Two trees of the features a and b: 0.2 or 0.6 by a <= 1; and 0.4 or, by b <= 0, 0.8 or 1.0 if a > 2."""
    padding = (LEAF, 0, 0.0)
    first = [(0, 2, 1.0), (LEAF, 0, 0.2), (LEAF, 0, 0.6), padding, padding]
    second = [(0, 2, 2.0), (LEAF, 0, 0.4), (1, 4, 0.0), (LEAF, 0, 0.8), (LEAF, 0, 1.0)]
    return Forest(("a", "b"), np.array([first, second], dtype=NODE))


def test_the_mean_is_that_of_the_leaves_that_a_row_reaches():
    rows = np.array([[1.0, 9.0], [1.5, 9.0], [3.0, 0.0], [3.0, 0.1]])
    np.testing.assert_allclose(stumps().mean(rows), [0.3, 0.5, 0.7, 0.8], rtol=1e-6)


def test_a_document_contains_the_whole_forest():
    forest = stumps()
    again = Forest.from_document(json.loads(json.dumps(forest.document())))
    assert again.names == forest.names
    np.testing.assert_array_equal(again.nodes, forest.nodes)


def test_no_rows_have_no_means():
    assert stumps().mean(np.empty((0, 2))).shape == (0,)
