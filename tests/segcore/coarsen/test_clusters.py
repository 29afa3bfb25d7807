import numpy as np

from segcore import shapes
from segcore.affinity.mesh_graphs import mesh_graph
from segcore.clean.surface import build_surface
from segcore.coarsen.clusters import cluster_nodes, clusters_of
from segcore.parameters import SegmentationParameters


def test_clusters_that_are_given_have_the_graph_that_coarsening_gives_them():
    nodes = mesh_graph(build_surface(shapes.burr(4).mesh), SegmentationParameters(affinity="concavity"))
    coarse = cluster_nodes(nodes, 300, np.random.default_rng(0))
    given = clusters_of(nodes, coarse.of_node)
    difference = abs(given.graph.adjacency() - coarse.graph.adjacency())
    assert difference.max() < 1e-12
    assert np.isclose(given.graph.length.sum(), coarse.graph.length.sum(), rtol=1e-12)
    np.testing.assert_array_equal(given.graph.volume, coarse.graph.volume)
    np.testing.assert_array_equal(given.points, coarse.points)
    np.testing.assert_array_equal(given.thickness, coarse.thickness)
