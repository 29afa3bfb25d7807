import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.graphs import (
    all_sides,
    best_ncc,
    cuts,
    cycle,
    graphs,
    grid,
    improve,
    mesh_like,
    path,
    two_cliques,
    weighted_graph,
)
from segcore.graphs.cheeger import cut_of, ncc, sweep
from segcore.graphs.surface_graph import SurfaceGraph
from segcore.solvers.fiedler import fiedler_vectors
from segcore.solvers.flow import flow_cut


@st.composite
def graphs_with_sides(draw: st.DrawFn) -> tuple[SurfaceGraph, np.ndarray]:
    graph = draw(graphs())
    side = np.array(draw(st.lists(st.booleans(), min_size=graph.node_count, max_size=graph.node_count)))
    side[0], side[-1] = True, False
    return graph, side


@given(graphs_with_sides())
def test_improving_never_raises_the_value_and_ends_where_no_flow_lowers_it(
    case: tuple[SurfaceGraph, np.ndarray],
) -> None:
    graph, side = case
    cut = improve(graph, side)
    assert best_ncc(graph) * (1 - 1e-9) <= cut.ncc <= ncc(graph, side)
    small = cut.side if cut.inside <= cut.outside else ~cut.side
    sides = all_sides(graph.node_count)
    subgradient = np.where(
        small, graph.volume, -min(cut.inside, cut.outside) / max(cut.inside, cut.outside) * graph.volume
    )
    assert (cuts(graph, sides) >= cut.ncc * (sides @ subgradient) - 1e-9).all()


@given(graphs_with_sides())
def test_no_subset_of_an_improved_side_is_better(case: tuple[SurfaceGraph, np.ndarray]) -> None:
    graph, side = case
    cut = improve(graph, side)
    small = cut.side if cut.inside <= cut.outside else ~cut.side
    subsets = all_sides(graph.node_count) & small
    subsets = subsets[subsets.any(axis=1)]
    assert (cuts(graph, subsets) / (subsets @ graph.volume)).min() >= cut.ncc * (1 - 1e-9)


@given(graphs())
def test_the_cut_is_between_the_best_one_and_the_sweep_of_the_fiedler_vector(graph: SurfaceGraph) -> None:
    swept = sweep(graph, fiedler_vectors(graph)[:, 0])
    for count in (1, 2, 4):
        assert best_ncc(graph) * (1 - 1e-9) <= flow_cut(graph, count=count).ncc <= swept.ncc


@given(graphs(decades=6))
def test_weights_and_volumes_over_twelve_decades_do_no_harm(graph: SurfaceGraph) -> None:
    cut = flow_cut(graph)
    assert best_ncc(graph) * (1 - 1e-9) <= cut.ncc <= sweep(graph, fiedler_vectors(graph)[:, 0]).ncc


@pytest.mark.parametrize("bridge", [1e-3, 1e-9, 1e-15])
def test_a_weak_edge_between_two_cliques_is_cut(bridge: float) -> None:
    assert flow_cut(two_cliques(12, bridge)).weight == bridge


@pytest.mark.parametrize("node_count", [2, 3, 10, 101])
def test_a_path_is_cut_in_the_middle(node_count: int) -> None:
    """The volume of all nodes is 2 (N - 1), and one edge is cut."""
    assert flow_cut(path(node_count)).ncc == pytest.approx(1 / (2 * (node_count // 2) - 1))


@pytest.mark.parametrize("node_count", [4, 10, 100])
def test_a_cycle_is_halved(node_count: int) -> None:
    assert flow_cut(cycle(node_count)).ncc == pytest.approx(2 / node_count)


@pytest.mark.parametrize("size", [3, 10, 40])
def test_two_cliques_are_parted_at_the_bridge(size: int) -> None:
    cut = flow_cut(two_cliques(size))
    assert cut.ncc == pytest.approx(1 / (size * (size - 1) + 1))
    assert len(set(cut.side[:size])) == len(set(cut.side[size:])) == 1


def test_a_grid_is_cut_across_from_a_ragged_start() -> None:
    graph = grid(20, 40)
    start = (np.add.outer(np.arange(20) % 7, np.arange(40)) < 22).ravel()
    assert improve(graph, start).weight < cut_of(graph, start).weight
    assert flow_cut(graph).ncc == pytest.approx(20 / 400)


def test_sides_may_be_given_either_way_round() -> None:
    graph = mesh_like(3)
    side = sweep(graph, fiedler_vectors(graph, 2)[:, 1]).side
    assert improve(graph, side).ncc == improve(graph, ~side).ncc


def test_nothing_changes_with_the_units_of_weights_and_volumes() -> None:
    graph = mesh_like(5)
    scaled = weighted_graph(graph.edges, 2.0**-40 * graph.weight, 2.0**30 * graph.volume)
    assert (flow_cut(graph).side == flow_cut(scaled).side).all()


def test_a_graph_that_is_not_connected_is_refused() -> None:
    graph = grid(2, 2)
    with pytest.raises(ValueError, match="not connected"):
        flow_cut(weighted_graph(graph.edges[:1], graph.weight[:1], graph.volume))
