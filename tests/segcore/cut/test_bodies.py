"""Bodies, and the cuts between them."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from helpers.graphs import is_connected
from segcore.cut.bodies import MOST_CUTS, Bodies, cuts_between_pieces, pieces_of
from segcore.graphs.surface_graph import SurfaceGraph, connected_components


def graph_of(pairs, count, weight=None):
    edges = np.sort(np.array(pairs, dtype=np.int32), axis=1)
    weights = np.ones(len(edges)) if weight is None else np.array(weight)
    return SurfaceGraph(edges, weights, np.ones(count), np.ones(len(edges)))


def test_bodies_of_about_the_same_size_and_proportions_repeat() -> None:
    rng = np.random.default_rng(0)
    rod, ball = rng.normal(size=(20, 3)) * [4, 1, 1], rng.normal(size=(20, 3))
    points = np.concatenate([rod, ball, rod[:, [1, 0, 2]] + 30, rod - 50, 2 * ball + 90])
    body = np.repeat(np.arange(5), 20).astype(np.int32)
    volume = np.repeat([1.0, 1.0, 1.0, 1.0, 4.0], 20)
    assert Bodies.of(body, volume, points).repeats.tolist() == [3, 1, 3, 3, 1]


def test_a_piece_is_a_connected_part_of_one_body() -> None:
    graph = graph_of([(0, 1), (1, 2), (2, 3), (3, 4), (4, 5)], 6)
    assert pieces_of(graph, np.array([0, 0, 1, 1, 0, 0], dtype=np.int32)).tolist() == [0, 0, 1, 1, 2, 2]


def test_a_chain_is_cut_at_its_weakest_contacts_first() -> None:
    graph = graph_of([(0, 1), (1, 2), (2, 3), (3, 4)], 5, [1.0, 0.5, 1.0, 0.1])
    piece = np.arange(5, dtype=np.int32)
    first, second, *_ = cuts_between_pieces(graph, piece)
    assert first.side.tolist() == [True, True, True, True, False]
    assert second.side.tolist() == [True, True, False, False, False]


@settings(max_examples=60)
@given(st.integers(0, 10**6), st.integers(2, 30))
def test_cuts_between_pieces_divide_no_piece_and_have_connected_sides(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    tree = [(int(rng.integers(0, i)), i) for i in range(1, count)]
    extra = [tuple(sorted(rng.choice(count, 2, replace=False).tolist())) for _ in range(count)]
    graph = graph_of(sorted({*tree, *extra}), count)
    graph = SurfaceGraph(graph.edges, rng.random(len(graph.edges)) + 0.01, rng.random(count) + 0.1, graph.length)
    joined = np.array(tree)[rng.random(len(tree)) < 0.4]
    piece = connected_components(joined.astype(np.int32).reshape(-1, 2), count)
    cuts = cuts_between_pieces(graph, piece)
    assert len(cuts) == min(MOST_CUTS, piece.max())
    assert len({cut.key for cut in cuts}) == len(cuts)
    np.testing.assert_array_less(-1e-9, np.diff([cut.ncc for cut in cuts]))
    for cut in cuts:
        assert is_connected(graph, cut.side)
        assert is_connected(graph, ~cut.side)
        assert all(len(set(cut.side[piece == p].tolist())) == 1 for p in range(piece.max() + 1))


def test_one_piece_has_no_cuts_between_pieces() -> None:
    assert cuts_between_pieces(graph_of([(0, 1)], 2), np.zeros(2, dtype=np.int32)) == []
