import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.sparse.csgraph import connected_components as scipy_components

from helpers.graphs import graphs, laplacian
from segcore.graphs.surface_graph import SurfaceGraph, connected_components


@given(graphs(connected=False))
def test_the_rows_list_every_edge_at_both_ends(graph: SurfaceGraph) -> None:
    rows = graph.rows()
    node = np.repeat(np.arange(graph.node_count), np.diff(rows.start))
    ends = graph.edges[rows.edge]
    assert (np.sort(np.stack([node, rows.neighbour], axis=1), axis=1) == ends).all()
    assert (np.bincount(rows.edge, minlength=len(graph.edges)) == 2).all()


@given(graphs(connected=False))
def test_the_adjacency_and_the_degrees_make_the_laplacian(graph: SurfaceGraph) -> None:
    L = np.diag(graph.degrees()) - graph.adjacency().toarray()
    np.testing.assert_allclose(L, laplacian(graph), rtol=1e-14)


@given(graphs(connected=False), st.data())
def test_a_subgraph_is_a_submatrix_in_the_order_of_its_nodes(graph: SurfaceGraph, data: st.DataObject) -> None:
    order = data.draw(st.permutations(range(graph.node_count)))
    nodes = np.array(order[: data.draw(st.integers(1, graph.node_count))], dtype=np.int32)
    part = graph.subgraph(nodes)
    assert (part.edges[:, 0] < part.edges[:, 1]).all()
    np.testing.assert_array_equal(part.adjacency().toarray(), graph.adjacency().toarray()[np.ix_(nodes, nodes)])
    np.testing.assert_array_equal(part.volume, graph.volume[nodes])


@given(graphs(connected=False))
def test_components_are_those_of_scipy_numbered_by_their_smallest_nodes(graph: SurfaceGraph) -> None:
    component = connected_components(graph.edges, graph.node_count)
    _, expected = scipy_components(graph.adjacency(), directed=False)
    assert component.dtype == np.int32
    np.testing.assert_array_equal(component, expected)
