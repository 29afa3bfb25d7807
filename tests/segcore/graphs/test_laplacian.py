import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.graphs import graph_of, graphs, laplacian, mesh_like
from segcore.graphs.laplacian import Elimination, factorise, factorise_edges
from segcore.graphs.surface_graph import SurfaceGraph, connected_components


@given(graphs(most_nodes=14, connected=False))
def test_the_factors_multiply_to_the_laplacian(graph: SurfaceGraph) -> None:
    factor = factorise(graph)
    column = np.repeat(np.arange(graph.node_count), np.diff(factor.start))
    unit = np.eye(graph.node_count)
    unit[factor.row, column] = -factor.share
    product = unit @ np.diag(factor.pivot) @ unit.T
    np.testing.assert_allclose(product, laplacian(graph)[np.ix_(factor.order, factor.order)], atol=1e-12)


@given(graphs(most_nodes=14, connected=False))
def test_there_is_one_zero_pivot_for_each_component(graph: SurfaceGraph) -> None:
    assert factorise(graph).component_count == connected_components(graph.edges, graph.node_count).max() + 1


@given(st.integers(0, 1000))
def test_solutions_solve(seed: int) -> None:
    graph = mesh_like(seed)
    b = np.random.default_rng(seed).standard_normal(graph.node_count)
    b -= b.mean()
    np.testing.assert_allclose(laplacian(graph) @ factorise(graph).solve(b), b, atol=1e-9)


def test_every_digit_is_right_when_weights_span_thirty_decades() -> None:
    """A unit flow along a path: the potential falls by 1 / weight on every edge."""
    weight = 10.0 ** np.array([-15, 3, -9, 15, 0, -12, 7])
    graph = graph_of([(i, i + 1) for i in range(7)], weight.tolist())
    potential = factorise(graph).solve(np.array([1.0, 0, 0, 0, 0, 0, 0, -1.0]))
    assert potential[0] - potential[-1] == pytest.approx((1 / weight).sum(), rel=1e-14)
    last = graph_of([(0, 1), (1, 2), (0, 2)], [1e-15, 1e-15, 1e15])
    assert factorise(last).pivot.min(where=factorise(last).pivot > 0, initial=np.inf) == pytest.approx(2e-15, rel=1e-14)


def test_an_elimination_serves_all_weights_of_a_graph() -> None:
    graph = mesh_like(0)
    elimination = Elimination.of(graph.edges, graph.node_count)
    for weight in (graph.weight, 3 * graph.weight**2):
        again, alone = elimination.factorise(weight), factorise_edges(graph.edges, weight, graph.node_count)
        assert [array.tolist() for array in again] == [array.tolist() for array in alone]
