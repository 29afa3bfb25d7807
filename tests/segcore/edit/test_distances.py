from itertools import pairwise

import numpy as np
import pytest
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components, dijkstra

from segcore.edit.distances import (
    distances_from,
    distances_from_border,
    marked_components,
    nearest_seed,
    shortest_path,
)
from segcore.graphs.surface_graph import rows_of


@pytest.fixture(params=range(5))
def graph(request):
    """The adjacency lists of a random graph, the lengths of its edges, and the same as a matrix."""
    rng = np.random.default_rng(request.param)
    pairs = np.unique(np.sort(rng.integers(0, 40, (90, 2)), axis=1), axis=0)
    edges = pairs[pairs[:, 0] != pairs[:, 1]].astype(np.int32)
    step = rng.random(len(edges)) + 0.1
    return rows_of(edges, 40), step, csr_matrix((step, (edges[:, 0], edges[:, 1])), shape=(40, 40)), edges


def test_distances_from_nodes_are_those_of_scipy(graph):
    rows, step, matrix, _ = graph
    expected = dijkstra(matrix, directed=False, indices=[3, 7]).min(axis=0)
    np.testing.assert_allclose(distances_from(rows, step, np.array([3, 7]), np.inf), expected)
    limited = distances_from(rows, step, np.array([3, 7]), 1.0)
    np.testing.assert_allclose(limited, np.where(expected <= 1.0, expected, np.inf))


def test_distances_from_the_border_start_in_the_middle_of_the_edges_that_leave(graph):
    rows, step, matrix, edges = graph
    region = np.arange(40) < 25
    inner = matrix.copy().tolil()
    inner[~region] = 0
    inner[:, ~region] = 0
    crossing = edges[region[edges[:, 0]] != region[edges[:, 1]]]
    start = {}
    for (one, other), length in zip(edges.tolist(), step.tolist(), strict=True):
        if region[one] != region[other]:
            at = one if region[one] else other
            start[at] = min(start.get(at, np.inf), 0.5 * length)
    assert len(crossing)
    between = dijkstra(inner.tocsr(), directed=False, indices=list(start))
    expected = (between + np.array(list(start.values()))[:, None]).min(axis=0)
    expected[~region] = np.inf
    np.testing.assert_allclose(distances_from_border(rows, step, region, np.inf), expected)


def test_the_nearest_seed_has_the_least_distance(graph):
    rows, step, matrix, _ = graph
    seeds = np.array([1, 20, 33])
    away = dijkstra(matrix, directed=False, indices=seeds)
    nearest = nearest_seed(rows, step, np.ones(40, dtype=bool), seeds)
    reached = np.isfinite(away.min(axis=0))
    np.testing.assert_array_equal(nearest[reached], away.argmin(axis=0)[reached])
    assert (nearest[~reached] == -1).all()


def test_a_shortest_path_has_the_length_of_scipys(graph):
    rows, step, matrix, edges = graph
    length = {tuple(edge): value for edge, value in zip(edges.tolist(), step.tolist(), strict=True)}
    away = dijkstra(matrix, directed=False, indices=0)
    for target in np.flatnonzero(np.isfinite(away))[1:].tolist():
        path = shortest_path(rows, step, np.ones(40, dtype=bool), 0, target).tolist()
        assert path[0] == 0
        assert path[-1] == target
        total = sum(length[tuple(sorted(pair))] for pair in pairwise(path))
        assert total == pytest.approx(away[target])


def test_a_path_between_unconnected_nodes_has_its_ends_alone():
    rows = rows_of(np.array([[0, 1], [2, 3]], dtype=np.int32), 4)
    path = shortest_path(rows, np.ones(2), np.ones(4, dtype=bool), 0, 3)
    np.testing.assert_array_equal(path, [0, 3])


def test_the_components_of_marked_nodes_are_those_of_scipy(graph):
    rows, _, matrix, _ = graph
    inside = np.arange(40) % 5 != 2
    kept = matrix.tolil()
    kept[~inside] = 0
    kept[:, ~inside] = 0
    component = connected_components(kept.tocsr(), directed=False)[1]
    marked = np.array([0, 8, 31], dtype=np.int32)
    found = marked_components(rows, inside, marked)
    np.testing.assert_array_equal(found, np.isin(component, component[marked]) & inside)
