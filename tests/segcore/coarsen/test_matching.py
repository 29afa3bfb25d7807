import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from segcore.coarsen.matching import coarsen
from segcore.graphs.surface_graph import SurfaceGraph, connected_components


@st.composite
def graphs(draw):
    count = draw(st.integers(2, 40))
    chosen = draw(st.sets(st.tuples(st.integers(0, count - 1), st.integers(0, count - 1)), min_size=1, max_size=120))
    edges = np.array(sorted({(min(p), max(p)) for p in chosen if p[0] != p[1]} | {(0, 1)}), np.int32)
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    length = rng.uniform(0.5, 2, len(edges))
    return SurfaceGraph(edges, rng.uniform(0.03, 1, len(edges)) * length, rng.uniform(0.5, 2, count), length)


@settings(max_examples=60)
@given(graphs(), st.integers(1, 20), st.integers(0, 5))
def test_clusters_are_connected_and_sums_are_kept(graph, target, seed):
    coarse, cluster = coarsen(graph, target, np.random.default_rng(seed))
    assert set(cluster) == set(range(coarse.node_count))
    np.testing.assert_allclose(coarse.volume, np.bincount(cluster, graph.volume))
    inside = cluster[graph.edges[:, 0]] == cluster[graph.edges[:, 1]]
    assert connected_components(graph.edges[inside], graph.node_count).max() + 1 == coarse.node_count
    W = np.zeros((coarse.node_count, coarse.node_count))
    ends = cluster[graph.edges[~inside]]
    np.add.at(W, (ends.min(axis=1), ends.max(axis=1)), graph.weight[~inside])
    np.testing.assert_allclose(coarse.adjacency().toarray(), W + W.T)
    np.testing.assert_allclose(coarse.length.sum(), graph.length[~inside].sum())
    assert (coarse.edges[:, 0] < coarse.edges[:, 1]).all()


@settings(max_examples=30)
@given(graphs(), st.integers(0, 5))
def test_a_graph_small_enough_is_left_alone(graph, seed):
    coarse, cluster = coarsen(graph, graph.node_count, np.random.default_rng(seed))
    np.testing.assert_array_equal(cluster, np.arange(graph.node_count))
    np.testing.assert_array_equal(coarse.adjacency().toarray(), graph.adjacency().toarray())


def test_no_cluster_crosses_a_concavity_while_others_can_still_be_merged():
    """Two rings of 60 nodes joined by weak edges: 10 clusters can be had without crossing."""
    around = [(i, (i + 1) % 60) for i in range(60)]
    edges = [tuple(sorted(e)) for e in around] + [tuple(sorted((a + 60, b + 60))) for a, b in around]
    edges += [(i, i + 60) for i in range(60)]
    affinity = np.array([1.0] * 120 + [0.1] * 60)
    graph = SurfaceGraph(np.array(edges, np.int32), affinity, np.ones(120), np.ones(180))
    _, cluster = coarsen(graph, 40, np.random.default_rng(0))
    assert not set(cluster[:60]) & set(cluster[60:])
