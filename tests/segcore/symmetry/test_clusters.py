import numpy as np
import pytest

from helpers.meshes import rotation
from helpers.shapes.creatures import creature
from segcore.affinity.mesh_graphs import mesh_graph
from segcore.clean.surface import build_surface
from segcore.coarsen.clusters import cluster_nodes
from segcore.graphs.surface_graph import connected_components
from segcore.parameters import SegmentationParameters
from segcore.symmetry.clusters import clusters_with_images, local_image, symmetrised
from segcore.symmetry.images import mirror_image

TURN = rotation(np.random.default_rng(3))


def clustered(mesh, target):
    surface = build_surface(mesh)
    nodes = mesh_graph(surface, SegmentationParameters(affinity="concavity"))
    mirror = mirror_image(surface)
    return nodes, mirror, clusters_with_images(nodes, mirror, target, np.random.default_rng(0))


@pytest.mark.parametrize(
    ("mesh", "target"),
    [(creature(), 400), (creature(), 0), (creature(TURN, 5), 600)],
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
    ends = raw.of_node[nodes.graph.edges]
    real = {(min(pair), max(pair)) for pair in ends[ends[:, 0] != ends[:, 1]].tolist()}
    assert set(map(tuple, clusters.graph.edges.tolist())) <= real


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


def test_a_graph_that_falls_apart_without_the_edges_of_one_side_has_no_images():
    """Of single faces of a mesh that is not symmetric, many have no neighbour whose image is a neighbour."""
    nodes, mirror, clusters = clustered(creature(TURN), 0)
    assert mirror is not None
    assert clusters.image is None
    np.testing.assert_array_equal(clusters.of_node, np.arange(nodes.graph.node_count))
