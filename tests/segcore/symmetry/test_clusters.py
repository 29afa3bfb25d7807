from dataclasses import replace

import numpy as np
import pytest

from helpers.bodies.creatures import creature
from helpers.graphs import graph_of
from helpers.meshes import rotation
from segcore.affinity.mesh_graphs import mesh_graph
from segcore.clean.surface import build_surface
from segcore.coarsen.clusters import Clusters, cluster_nodes
from segcore.graphs.surface_graph import connected_components
from segcore.graphs.tree import Tree
from segcore.parameters import SegmentationParameters
from segcore.symmetry.clusters import clusters_with_images, local_image, symmetrised, with_connected_leaves
from segcore.symmetry.images import mirror_image

TURN = rotation(np.random.default_rng(3))


def clustered(mesh, target):
    surface = build_surface(mesh)
    nodes = mesh_graph(surface, SegmentationParameters(affinity="concavity"))
    mirror = mirror_image(surface)
    return nodes, mirror, clusters_with_images(nodes, mirror, target, np.random.default_rng(0))


@pytest.mark.parametrize(
    ("mesh", "target"),
    [(creature(), 400), (creature(), 0), (creature(TURN, 5), 600), (creature(TURN), 0)],
)
def test_the_clusters_and_their_graph_are_symmetric_on_any_meshing(mesh, target):
    nodes, mirror, raw = clustered(mesh, target)
    inside = (raw.of_node[nodes.graph.edges][:, 0] == raw.of_node[nodes.graph.edges][:, 1]).nonzero()[0]
    pieces = connected_components(nodes.graph.edges[inside], nodes.graph.node_count)
    assert pieces.max() + 1 == raw.graph.node_count == len(np.unique(raw.of_node))
    np.testing.assert_array_equal(raw.image[raw.image], np.arange(raw.graph.node_count))
    assert (raw.image != np.arange(raw.graph.node_count)).all()
    of_first = raw.of_node[mirror.is_first]
    assert len(np.intersect1d(of_first, raw.of_node[~mirror.is_first])) == 0
    clusters = symmetrised(raw, mirror)
    adjacency = clusters.graph.adjacency()
    assert (adjacency != adjacency[clusters.image][:, clusters.image]).nnz == 0
    np.testing.assert_array_equal(clusters.graph.volume, clusters.graph.volume[clusters.image])
    np.testing.assert_array_equal(clusters.thickness, clusters.thickness[clusters.image])
    assert clusters.graph.total_volume == pytest.approx(nodes.graph.total_volume)
    assert clusters.graph.weight.sum() == pytest.approx(raw.graph.weight.sum())


def test_on_a_symmetric_mesh_the_clusters_of_two_faces_that_are_images_are_images():
    nodes, mirror, clusters = clustered(creature(), 400)
    beside = np.abs(mirror.reflection.heights(nodes.points)) > 1e-9  # the plane halves the other faces
    images = clusters.image[clusters.of_node]
    # A piece that only a face across the plane connects to its cluster is on one side alone.
    assert (clusters.of_node[mirror.of_face[beside]] == images[beside]).mean() > 0.999


def test_without_a_mirror_image_the_clusters_are_those_of_any_mesh():
    nodes, _, _ = clustered(creature(missing=1), 400)
    ours = symmetrised(clusters_with_images(nodes, None, 400, np.random.default_rng(0)), None)
    plain = cluster_nodes(nodes, 400, np.random.default_rng(0))
    np.testing.assert_array_equal(ours.of_node, plain.of_node)
    np.testing.assert_array_equal(ours.graph.weight, plain.graph.weight)
    assert ours.image is None


def test_images_within_a_set_of_nodes():
    image = np.array([3, 4, 5, 0, 1, 2], dtype=np.int32)
    np.testing.assert_array_equal(local_image(np.array([1, 2, 4, 5]), image), [2, 3, 0, 1])
    assert local_image(np.array([0, 1, 4]), image) is None
    assert local_image(np.array([0, 1]), image) is None


def test_a_leaf_that_an_edge_of_the_other_half_connects_loses_its_smaller_piece():
    """Clusters 0..2 and their images 3..5; cluster 1 is next to 2, but 4 is not next to 5."""
    graph = graph_of([(0, 1), (1, 2), (0, 3), (3, 4), (3, 5)], [1.0] * 5, np.ones(6))
    image = np.roll(np.arange(6, dtype=np.int32), 3)
    clusters = Clusters(
        graph, np.arange(6, dtype=np.int32), np.zeros((6, 3)), None, None, np.zeros(6, dtype=np.int32), image=image
    )
    leaf = np.array([3, 1, 1, 3, 4, 4], dtype=np.int32)
    tree = Tree(np.array([0, 2], dtype=np.int32), np.ones(2), leaf, 3)
    assert not tree.is_connected(graph)
    repaired = with_connected_leaves(tree, clusters)
    np.testing.assert_array_equal(repaired.leaf, [3, 1, 1, 3, 4, 3])
    assert repaired.is_connected(graph)
    assert with_connected_leaves(tree, replace(clusters, image=None)) is tree
