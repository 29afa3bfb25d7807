import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from helpers.bodies.creatures import creature
from helpers.graphs import is_connected, weighted_graph
from helpers.meshes import rotation
from helpers.trees import members
from segcore.affinity.mesh_graphs import mesh_graph
from segcore.clean.surface import build_surface
from segcore.coarsen.contacts import Links
from segcore.cut.bisection import bisect
from segcore.cut.rules import AUTOMATIC_NCUT, RatioRule, paired, split_rule
from segcore.graphs.surface_graph import connected_components
from segcore.parameters import SegmentationParameters
from segcore.symmetry.clusters import clusters_with_images, symmetrised
from segcore.symmetry.images import mirror_image


def graph_of(pairs, count, weights=None, volume=None):
    edges = np.array(sorted({(min(p), max(p)) for p in pairs}), np.int32).reshape(-1, 2)
    weight = np.ones(len(edges)) if weights is None else weights
    return weighted_graph(edges, weight, np.ones(count) if volume is None else volume)


@st.composite
def graphs(draw):
    count = draw(st.integers(1, 25))
    node = st.integers(0, count - 1)
    pairs = [p for p in draw(st.lists(st.tuples(node, node), max_size=60)) if p[0] != p[1]]
    graph = graph_of(pairs, count)
    rng = np.random.default_rng(draw(st.integers(0, 1000)))
    return weighted_graph(graph.edges, rng.uniform(0.1, 2, len(graph.edges)), rng.uniform(0.2, 2, count))


def grown(graph, max_segments):
    rng = np.random.default_rng(0)
    rule = RatioRule(graph, SegmentationParameters(order="ncut"), rng)
    return bisect(graph, rng.random((graph.node_count, 3)), rule, max_segments)


@settings(max_examples=80)
@given(graphs())
def test_every_segment_of_every_level_is_connected_within_its_component(graph):
    tree = grown(graph, 50)
    components = int(connected_components(graph.edges, graph.node_count).max()) + 1
    for nodes in members(tree)[2 * (components - 1) + 1 :]:
        assert is_connected(graph, nodes)


@settings(max_examples=80)
@given(graphs())
def test_splitting_ends_when_every_segment_is_one_node(graph):
    tree = grown(graph, 10_000)
    assert len(tree.split_node) + 1 == graph.node_count
    assert len(set(tree.leaf)) == graph.node_count


def test_the_least_normalized_cut_is_made_first():
    """Three cliques in a row, the second bridge stronger than the first."""
    cliques = [(5 * c + i, 5 * c + j) for c in range(3) for i in range(5) for j in range(i)]
    graph = graph_of([*cliques, (4, 5), (9, 10)], 15)
    weight = np.where((graph.edges == [9, 10]).all(axis=1), 0.5, graph.weight)
    weight[(graph.edges == [4, 5]).all(axis=1)] = 0.1
    tree = grown(weighted_graph(graph.edges, weight, graph.volume), 3)
    np.testing.assert_array_equal(tree.split_node, [0, 1])
    np.testing.assert_array_equal(tree.leaf, np.repeat([2, 3, 4], 5))
    np.testing.assert_allclose(tree.cut_value, np.sqrt(15) * np.array([0.1 * (1 / 5 + 1 / 10), 0.5 * (1 / 5 + 1 / 5)]))


def test_the_automatic_number_counts_the_cuts_below_the_threshold():
    cliques = [(5 * c + i, 5 * c + j) for c in range(4) for i in range(5) for j in range(i)]
    graph = graph_of([*cliques, (4, 5), (9, 10), (14, 15)], 20)
    tree = grown(graph, 20)
    below = np.argmax(tree.cut_value >= AUTOMATIC_NCUT)
    assert tree.automatic_segments == below + 1
    assert 1 < tree.automatic_segments < 20


def test_a_side_of_less_than_a_five_hundredth_waits_for_all_others():
    """Two halves joined by a strong edge and a tiny node at a weak one: the weak edge is by far the better cut."""
    graph = graph_of([(0, 1), (1, 2)], 3, np.array([0.5, 1e-9]), np.array([1.0, 1.0, 0.001]))
    tree = grown(graph, 3)
    assert tree.leaf[1] != tree.leaf[2]
    assert tree.split_node[1] == np.flatnonzero(np.isin(np.arange(5), [1, 2]) & ~np.isin(np.arange(5), tree.leaf))[0]


@settings(max_examples=40)
@given(graphs())
def test_the_limit_is_reached_if_and_only_if_it_leaves_a_cut_that_is_not_late(graph):
    whole = grown(graph, 10_000)
    assert not whole.limit_reached
    segments = len(whole.split_node) + 1
    for limit in {1, segments // 2, segments - 1} - {0}:
        left = grown(graph, limit)
        if len(left.split_node) + 1 == limit < segments:
            sides = [np.bincount(left.leaf)[leaf] for leaf in set(left.leaf)]
            assert left.limit_reached == (max(sides) > 1)


def test_cuts_of_less_than_a_five_hundredth_do_not_count_as_left():
    """Two segments of a chain of four nodes, the last two of which are tiny or not."""
    edges, weight = [(0, 1), (1, 2), (2, 3)], np.array([0.5, 1.0, 0.9])
    assert not grown(graph_of(edges, 4, weight, np.array([1.0, 1.0, 0.001, 0.001])), 2).limit_reached
    assert grown(graph_of(edges, 4, weight, np.ones(4)), 2).limit_reached


def test_splits_are_paired_if_their_step_has_several():
    assert paired(np.array([0, 1, 1, 2, 3, 3, 3])).tolist() == [False, True, True, False, True, True, True]
    assert paired(np.array([], dtype=np.int32)).tolist() == []


def symmetric_tree(mesh, max_segments, **parameters):
    """The tree of a symmetric body over its clusters, and the clusters."""
    chosen = SegmentationParameters(**parameters)
    surface = build_surface(mesh)
    nodes, mirror = mesh_graph(surface, chosen), mirror_image(surface)
    rng = np.random.default_rng(0)
    clusters = symmetrised(clusters_with_images(nodes, mirror, 600, rng), mirror)
    rule = split_rule(surface, clusters, Links.none(), chosen, rng)
    return bisect(clusters.graph, clusters.points, rule, max_segments, image=clusters.image), clusters


def labels_at(tree, splits):
    """(N,) the node of the tree that every node of the graph is in after some splits."""
    node = tree.leaf.copy()
    parent = np.repeat(tree.split_node, 2)
    while (deep := node > 2 * splits).any():
        node[deep] = parent[node[deep] - 1]
    return node


@pytest.mark.parametrize(
    "parameters",
    [{"affinity": "learned"}, {"affinity": "concavity"}, {"affinity": "concavity", "solver": "fiedler"}],
)
@pytest.mark.parametrize("turn", [None, rotation(np.random.default_rng(2))])
def test_after_every_step_the_segments_of_a_symmetric_body_are_symmetric(parameters, turn):
    tree, clusters = symmetric_tree(creature(turn), 30, **parameters)
    ends = 1 + np.flatnonzero(np.diff(tree.step, append=tree.step[-1] + 1))
    for splits in [*ends[:-1], tree.automatic_segments - 1]:
        labels = labels_at(tree, splits)
        pairs = np.unique(np.stack([labels, labels[clusters.image]]), axis=1)
        assert pairs.shape[1] == splits + 1  # every segment has one image
    assert tree.automatic_segments - 1 in (0, *ends)
    assert len(tree.split_node) == 29
    np.testing.assert_array_equal(np.unique(tree.step), np.arange(tree.step[-1] + 1))
    assert (np.diff(tree.step) >= 0).all()
    for nodes in members(tree):
        assert is_connected(clusters.graph, nodes)


def test_the_two_cuts_of_a_step_have_one_value():
    tree, _ = symmetric_tree(creature(), 30)
    size = np.bincount(tree.step)
    assert (size == 2).any()
    for step in np.flatnonzero(size == 2)[:-1]:
        first, second = tree.cut_value[tree.step == step]
        assert first == second


def test_the_limit_is_reached_within_a_step():
    for most in range(1, 9):
        tree, _ = symmetric_tree(creature(), most)
        assert len(tree.split_node) == most - 1


def test_components_that_are_images_of_each_other_are_cut_alike():
    """Two pairs of cliques with a bridge, apart from each other."""
    clique = [(i, j) for i in range(5) for j in range(i)]
    half = [*clique, *((i + 5, j + 5) for i, j in clique), (4, 5)]
    pairs = [*half, *((i + 10, j + 10) for i, j in half)]
    graph = graph_of(pairs, 20)
    image = np.roll(np.arange(20, dtype=np.int32), 10)
    points = np.arange(60, dtype=float).reshape(20, 3)
    rule = RatioRule(graph, SegmentationParameters(order="ncut"), np.random.default_rng(0))
    tree = bisect(graph, points, rule, 4, image=image)
    np.testing.assert_array_equal(tree.step, [0, 1, 1])
    assert len(np.unique(tree.leaf)) == 4
    assert all(len(np.unique(tree.leaf[5 * i : 5 * i + 5])) == 1 for i in range(4))


def test_without_images_every_split_is_a_step():
    np.testing.assert_array_equal(grown(graph_of([(i, i + 1) for i in range(9)], 10), 6).step, np.arange(5))
