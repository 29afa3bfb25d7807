import numpy as np
import pytest

from helpers.meshes import agreement, areas, pieces_of_labels
from segcore import shapes
from segcore.affinity.concave_regions import z_scores
from segcore.affinity.curvature import principal_curvatures
from segcore.affinity.mesh_graphs import mesh_graph
from segcore.clean.surface import build_surface
from segcore.errors import InvalidParameters
from segcore.graphs.surface_graph import connected_components
from segcore.mesh import Mesh
from segcore.method import segment
from segcore.parameters import SegmentationParameters

BURR = shapes.burr(4)


def graph_of(mesh, **choices):
    return mesh_graph(build_surface(mesh), SegmentationParameters(**choices))


def test_the_vertex_graph_with_the_standard_adjacency_has_degrees_as_volumes():
    graph = graph_of(BURR.mesh, graph="vertices", affinity="adjacency").graph
    assert (graph.weight == 1).all()
    np.testing.assert_array_equal(graph.volume, np.bincount(graph.edges.ravel()))
    assert len(graph.edges) == 3 * len(BURR.mesh.faces) // 2


def test_the_minima_rule_has_the_weights_of_the_paper():
    graph = graph_of(BURR.mesh, graph="vertices", affinity="minima_rule").graph
    curvatures = principal_curvatures(BURR.mesh.vertices, BURR.mesh.faces)
    z = z_scores(curvatures.k2)
    expected = [
        1.0 if min(z[a], z[b]) >= -0.8 else 0.1 if abs(z[a] - z[b]) >= 2 else 0.2 for a, b in graph.edges.tolist()
    ]
    np.testing.assert_array_equal(graph.weight, expected)
    np.testing.assert_allclose(graph.volume, graph.degrees())


def test_the_minima_rule_on_faces_weighs_lengths():
    made = graph_of(BURR.mesh, graph="faces", affinity="minima_rule")
    assert set(np.round(made.graph.weight / made.graph.length, 12)) <= {0.1, 0.2, 1.0}
    surface = build_surface(BURR.mesh)
    np.testing.assert_allclose(made.graph.volume, surface.areas)
    length = np.linalg.norm(np.subtract(*surface.vertices[surface.edge_vertices].transpose(1, 0, 2)), axis=1)
    np.testing.assert_allclose(made.graph.length, length)


def test_components_that_touch_at_a_vertex_have_a_node_each_there():
    touching = Mesh([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]], [[0, 1, 2], [0, 3, 4]])
    made = graph_of(touching, graph="vertices", affinity="adjacency")
    assert made.graph.node_count == 6
    assert connected_components(made.graph.edges, made.graph.node_count).max() == 1


@pytest.mark.parametrize("affinity", ["minima_rule", "adjacency"])
@pytest.mark.parametrize("graph", ["vertices", "faces"])
def test_segments_are_connected_sets_of_faces_on_every_graph(graph, affinity):
    parameters = SegmentationParameters(graph=graph, affinity=affinity, clusters=0, max_segments=12, solver="fiedler")
    hierarchy = segment(BURR.mesh, parameters)
    assert hierarchy.max_segments >= 8
    for k in range(1, hierarchy.max_segments + 1):
        assert pieces_of_labels(BURR.mesh, hierarchy.labels(k)) == k


@pytest.mark.parametrize("thinning", ["none", "walk"])
def test_the_minima_rule_parts_the_balls_of_a_dumbbell_on_the_vertex_graph(thinning):
    dumbbell = shapes.dumbbell()
    parameters = SegmentationParameters(
        graph="vertices", affinity="minima_rule", thinning=thinning, clusters=0, max_segments=3, solver="fiedler"
    )
    assert agreement(segment(dumbbell.mesh, parameters).labels(3), dumbbell.parts, areas(dumbbell.mesh)) > 0.9


def test_an_affinity_that_needs_faces_is_refused_on_vertices():
    with pytest.raises(InvalidParameters, match=r"concavity.*faces"):
        SegmentationParameters(graph="vertices", affinity="concavity")
