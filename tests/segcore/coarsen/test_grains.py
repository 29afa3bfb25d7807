import numpy as np
import pytest

from segcore import shapes
from segcore.clean.surface import build_surface
from segcore.coarsen import grains
from segcore.coarsen.grains import grains_of, grown_grains, merged_grains
from segcore.coarsen.matching import coarsen
from segcore.graphs.surface_graph import SurfaceGraph, components_inside

SURFACE = build_surface(shapes.dumbbell(rings=60, around=40).mesh)
RNG = np.random.default_rng(3)
WEIGHT = RNG.uniform(0.2, 1.0, len(SURFACE.edge_faces))
GRAPH = SurfaceGraph(SURFACE.edge_faces, WEIGHT, SURFACE.areas, np.ones(len(WEIGHT)))


@pytest.fixture
def fine(monkeypatch):
    """Grains of up to 15 nodes for a graph of 4,720."""
    monkeypatch.setattr(grains, "_COUNT", 300)
    monkeypatch.setattr(grains, "MANY", 1000)


@pytest.mark.usefixtures("fine")
def test_grains_are_connected_and_small_and_end_at_low_affinity():
    grain = grains_of(GRAPH)
    size = np.bincount(grain)
    assert size.max() == GRAPH.node_count // 300
    assert size.min() >= 1
    np.testing.assert_array_equal(components_inside(GRAPH.edges, grain), grain)
    strong = GRAPH.weight >= 0.5
    np.testing.assert_array_equal(components_inside(GRAPH.edges[strong], grain), grain)


def test_a_small_graph_has_no_grains():
    assert grains_of(GRAPH) is None


@pytest.mark.usefixtures("fine")
def test_the_graph_of_grains_has_the_sums_of_their_nodes_and_edges():
    grain = grown_grains(GRAPH)
    merged, number = merged_grains(GRAPH, grain)
    np.testing.assert_array_equal(number, grain)
    np.testing.assert_allclose(merged.volume, np.bincount(grain, GRAPH.volume))
    a, b = grain[GRAPH.edges].T
    weight = np.zeros((len(merged.volume), len(merged.volume)))
    np.add.at(weight, (np.minimum(a, b), np.maximum(a, b)), GRAPH.weight)
    np.fill_diagonal(weight, 0.0)
    np.testing.assert_array_equal(merged.edges, np.argwhere(weight))
    np.testing.assert_allclose(merged.weight, weight[tuple(merged.edges.T)])


@pytest.mark.usefixtures("fine")
def test_what_is_left_of_a_grain_in_a_part_of_the_graph_is_divided_if_no_high_affinity_connects_it():
    grain = grown_grains(GRAPH)
    nodes = np.flatnonzero(RNG.random(GRAPH.node_count) < 0.5).astype(np.int32)
    part = GRAPH.subgraph(nodes)
    _, number = merged_grains(part, grain[nodes])
    strong = part.weight >= 0.5 * part.length
    np.testing.assert_array_equal(components_inside(part.edges[strong], number), number)
    assert len(np.unique(np.stack([number, grain[nodes]]), axis=1).T) == number.max() + 1


@pytest.mark.usefixtures("fine")
def test_clusters_consist_of_grains():
    grain = grown_grains(GRAPH)
    coarse, cluster = coarsen(GRAPH, 50, np.random.default_rng(0), grain=grain)
    assert len(np.unique(np.stack([grain, cluster]), axis=1).T) == grain.max() + 1
    assert coarse.node_count == cluster.max() + 1 < 100
    np.testing.assert_allclose(coarse.volume, np.bincount(cluster, GRAPH.volume))
