from itertools import combinations

import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from helpers.graphs import cycle, is_connected, path, two_cliques, weighted_graph
from segcore.cut.symmetric_cuts import second_of_pair, symmetric_cuts, symmetric_sweeps
from segcore.graphs.ordering import minimum_degree
from segcore.graphs.surface_graph import connected_components


def reversal(count):
    return np.arange(count, dtype=np.int32)[::-1].copy()


@st.composite
def symmetric_graphs(draw):
    """A connected graph of 2 h nodes on which i -> i + h (mod 2 h) is an automorphism, and that map."""
    half = draw(st.integers(2, 7))
    count = 2 * half
    image = np.roll(np.arange(count, dtype=np.int32), half)
    pairs = draw(st.lists(st.sampled_from(list(combinations(range(count), 2))), min_size=1, max_size=14))
    orbits = {min((a, b), tuple(sorted((int(image[a]), int(image[b]))))) for a, b in pairs}
    rng = np.random.default_rng(draw(st.integers(0, 1000)))
    weight = {}
    for a, b in sorted(orbits):
        value = rng.uniform(0.1, 2.0)
        weight[a, b] = value
        weight[tuple(sorted((int(image[a]), int(image[b]))))] = value
    edges = np.array(sorted(weight), dtype=np.int32)
    volume = np.tile(rng.uniform(0.2, 2.0, half), 2)
    graph = weighted_graph(edges, np.array([weight[a, b] for a, b in edges.tolist()]), volume)
    assume(connected_components(graph.edges, count).max() == 0)
    return graph, image


def check(graph, image, cut):
    """The cut is its own image, or that of its complement, or disjoint from its image; all parts are connected."""
    side, mirrored = cut.side, cut.side[image]
    second = second_of_pair(side, image)
    parts = [side, ~side] if second is None else [side, second, ~(side | second), ~side]
    assert second is not None or (side == mirrored).all() or (side != mirrored).all()
    assert all(is_connected(graph, part) for part in parts)


@settings(max_examples=150)
@given(symmetric_graphs(), st.integers(0, 10**6))
def test_every_cut_has_a_symmetry_and_connected_parts(graph_and_image, seed):
    graph, image = graph_and_image
    sides = np.random.default_rng(seed).random((4, graph.node_count)) < 0.4
    for cut in symmetric_cuts(graph, image, [side for side in sides if side.any() and not side.all()]):
        check(graph, image, cut)
    for cut in symmetric_sweeps(graph, image, minimum_degree(graph.rows())):
        check(graph, image, cut)


def test_no_cut_is_offered_twice_and_the_image_of_a_cut_is_no_other_cut():
    graph, image = path(8), reversal(8)
    side = np.arange(8) < 2
    cuts = symmetric_cuts(graph, image, [side, side[image], ~side])
    assert len(cuts) == 1
    assert second_of_pair(cuts[0].side, image) is not None


def test_two_equal_limbs_are_a_pair_and_the_cut_between_two_halves_is_a_mirror_cut():
    """Cliques of nodes 0..4 and 10..14 as limbs of a larger clique 5..9, 15..19; then the same without a middle."""
    limb = list(combinations(range(5), 2))
    body = list(combinations([5, 6, 7, 8, 9, 15, 16, 17, 18, 19], 2))
    pairs = [*limb, *((a + 10, b + 10) for a, b in limb), *body, (4, 5), (14, 15)]
    edges = np.array(sorted(pairs), dtype=np.int32)
    graph = weighted_graph(edges, np.ones(len(edges)), np.ones(20))
    image = np.roll(np.arange(20, dtype=np.int32), 10)
    best = min(symmetric_sweeps(graph, image, minimum_degree(graph.rows())), key=lambda cut: cut.ncut)
    assert set(np.flatnonzero(best.side)) in ({0, 1, 2, 3, 4}, {10, 11, 12, 13, 14})
    assert set(np.flatnonzero(best.side | second_of_pair(best.side, image))) == {*range(5), *range(10, 15)}
    halves = two_cliques(6)
    best = min(symmetric_sweeps(halves, reversal(12), minimum_degree(halves.rows())), key=lambda cut: cut.ncut)
    assert set(np.flatnonzero(best.side)) in (set(range(6)), set(range(6, 12)))


def test_a_ring_whose_parts_alternate_has_no_symmetric_cut_of_that_kind():
    """Two opposite arcs and their images: neither pair of arcs leaves a connected rest."""
    graph = cycle(8)
    image = np.roll(np.arange(8, dtype=np.int32), 4)
    side = np.isin(np.arange(8), [0, 1, 4, 5])
    assert symmetric_cuts(graph, image, [side]) == []


def test_a_pair_is_disjoint_and_not_the_whole():
    image = reversal(4)
    np.testing.assert_array_equal(second_of_pair(np.array([True, False, False, False]), image), [False] * 3 + [True])
    assert second_of_pair(np.array([True, True, False, False]), image) is None
    assert second_of_pair(np.array([True, False, False, True]), image) is None
