import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from helpers.graphs import all_sides, cuts, cycle, graphs, is_connected, mesh_like
from segcore.graphs.cheeger import cut_of
from segcore.graphs.connected_sides import with_connected_sides
from segcore.graphs.surface_graph import SurfaceGraph


@settings(max_examples=80)
@given(graphs(most_nodes=25), st.data())
def test_both_sides_of_a_cut_become_connected(graph: SurfaceGraph, data: st.DataObject) -> None:
    side = np.array(data.draw(st.lists(st.booleans(), min_size=graph.node_count, max_size=graph.node_count)))
    if side.all() or not side.any():
        return
    cut = with_connected_sides(graph, cut_of(graph, side))
    assert is_connected(graph, cut.side)
    assert is_connected(graph, ~cut.side)


@given(st.integers(0, 1000))
def test_scattered_sides_of_a_large_graph_become_connected(seed: int) -> None:
    graph = mesh_like(seed, 10, 12)
    cut = with_connected_sides(graph, cut_of(graph, np.random.default_rng(seed).random(120) < 0.5))
    assert is_connected(graph, cut.side)
    assert is_connected(graph, ~cut.side)


@given(graphs(), st.data())
def test_connected_sides_are_kept(graph: SurfaceGraph, data: st.DataObject) -> None:
    sides = [side for side in all_sides(graph.node_count)[1:-1] if is_connected(graph, side)]
    side = data.draw(st.sampled_from([side for side in sides if is_connected(graph, ~side)]))
    np.testing.assert_array_equal(with_connected_sides(graph, cut_of(graph, side)).side, side)


def test_the_best_piece_of_a_cycle_is_cut_off() -> None:
    """Pieces of 1, 2, 3 and 6 nodes around a cycle: the largest one has the least normalized Cheeger cut."""
    graph = cycle(12)
    side = np.repeat([True, False, True, False], [1, 2, 3, 6])
    cut = with_connected_sides(graph, cut_of(graph, side))
    assert set(np.flatnonzero(cut.side == cut.side[11])) == set(range(6, 12))
    assert cut.ncc == pytest.approx(cuts(graph, cut.side[None])[0] / 12)


def test_a_piece_whose_volume_is_lost_in_rounding_is_not_cut_off() -> None:
    """A path a - b - c - d with the sides {a, d} and {b, c}: without a, the volume of the rest is that of all."""
    volume = np.array([1e-30, 1.0, 1.0, 1.0])
    graph = SurfaceGraph(np.array([[0, 1], [1, 2], [2, 3]], dtype=np.int32), np.ones(3), volume, np.ones(3))
    cut = with_connected_sides(graph, cut_of(graph, np.array([True, False, False, True])))
    assert cut.canonical.side.tolist() == [True, True, True, False]


def test_a_piece_beside_which_nothing_else_counts_is_not_divided_by_zero() -> None:
    """The same path if all volume is in b and c: no piece leaves any volume on both sides, and the first is cut off."""
    volume = np.array([1e-30, 1.0, 1.0, 1e-30])
    graph = SurfaceGraph(np.array([[0, 1], [1, 2], [2, 3]], dtype=np.int32), np.ones(3), volume, np.ones(3))
    with np.errstate(divide="raise"):
        cut = with_connected_sides(graph, cut_of(graph, np.array([True, False, False, True])))
    assert cut.canonical.side.tolist() == [True, False, False, False]
