from hypothesis import given

from helpers.graphs import graph_of, graphs, grid
from segcore.graphs.laplacian import factorise
from segcore.graphs.ordering import minimum_degree
from segcore.graphs.surface_graph import SurfaceGraph


@given(graphs(most_nodes=14, connected=False))
def test_the_order_is_a_permutation(graph: SurfaceGraph) -> None:
    assert sorted(minimum_degree(graph.rows()).tolist()) == list(range(graph.node_count))


@given(graphs(most_nodes=14))
def test_a_tree_gets_no_fill(graph: SurfaceGraph) -> None:
    tree = graph_of([(int(graph.edges[graph.edges[:, 1] == i][0, 0]), i) for i in range(1, graph.node_count)])
    assert len(factorise(tree).row) == tree.node_count - 1


def test_the_fill_of_a_grid_is_far_below_that_of_a_band() -> None:
    graph = grid(60, 60)
    assert len(factorise(graph).row) < 60**3 / 3


def test_a_node_with_thousands_of_neighbours_is_eliminated_last() -> None:
    star = graph_of([(0, i) for i in range(1, 3000)])
    assert minimum_degree(star.rows())[-1] == 0
