import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import maximum_flow

from segcore.edit.local_cut import minimum_cut
from segcore.graphs.surface_graph import rows_of


def cut_cost(edges, cost, inside):
    return cost[inside[edges[:, 0]] != inside[edges[:, 1]]].sum()


def scipy_minimum(edges, cost, inside, free):
    """The least cost by scipy's maximum flow from a source of the fixed inside to a sink of the fixed outside."""
    count = len(inside)
    node = np.where(free, np.arange(count), np.where(inside, count, count + 1))
    ends = node[edges]
    capacity = csr_matrix((cost.astype(np.int32), (ends[:, 0], ends[:, 1])), shape=(count + 2, count + 2))
    return maximum_flow(capacity + capacity.T, count, count + 1).flow_value


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=40)
def test_the_cost_is_that_of_a_maximum_flow(seed):
    rng = np.random.default_rng(seed)
    count = int(rng.integers(4, 30))
    pairs = np.unique(np.sort(rng.integers(0, count, (3 * count, 2)), axis=1), axis=0)
    edges = pairs[pairs[:, 0] != pairs[:, 1]].astype(np.int32)
    cost = rng.integers(1, 20, len(edges)).astype(float)
    inside, free = rng.random(count) < 0.5, rng.random(count) < 0.7
    inside[0], inside[1], free[:2] = True, False, False
    found = minimum_cut(rows_of(edges, count), cost, inside, free)
    assert (found == inside)[~free].all()
    assert cut_cost(edges, cost, found) == pytest.approx(scipy_minimum(edges, cost, inside, free))


def test_a_leaning_is_part_of_the_cost():
    edges = np.array([[0, 1], [1, 2], [2, 3]], dtype=np.int32)
    rows, cost = rows_of(edges, 4), np.array([5.0, 1.0, 5.0])
    inside, free = np.array([True, False, False, False]), np.array([False, True, True, False])
    np.testing.assert_array_equal(minimum_cut(rows, cost, inside, free), [True, True, False, False])
    leaning = np.array([0.0, 0.0, -5.0, 0.0])
    np.testing.assert_array_equal(minimum_cut(rows, cost, inside, free, leaning), [True, True, True, False])
