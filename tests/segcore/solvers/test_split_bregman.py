import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.graphs import best_ncc, cycle, graphs, grid, improve, mesh_like, path, two_cliques
from segcore.graphs.cheeger import sweep
from segcore.graphs.surface_graph import SurfaceGraph
from segcore.solvers.fiedler import fiedler_vectors
from segcore.solvers.split_bregman import split_bregman_cut


@given(graphs(), st.integers(1, 3), st.integers(1, 200))
def test_the_cut_is_between_the_best_one_and_the_sweep_of_the_fiedler_vector(
    graph: SurfaceGraph, starts: int, iterations: int
) -> None:
    cut = split_bregman_cut(graph, starts=starts, iterations=iterations, rng=np.random.default_rng(0))
    swept = sweep(graph, fiedler_vectors(graph)[:, 0])
    assert best_ncc(graph) * (1 - 1e-9) <= cut.ncc <= swept.ncc


@given(graphs())
def test_a_few_starts_come_near_the_best_cut_of_small_graphs(graph: SurfaceGraph) -> None:
    assert split_bregman_cut(graph, rng=np.random.default_rng(0)).ncc <= 1.25 * best_ncc(graph)


def test_closed_forms() -> None:
    rng = np.random.default_rng(0)
    assert split_bregman_cut(path(101), rng=rng).ncc == pytest.approx(1 / 99)
    assert split_bregman_cut(cycle(100), rng=rng).ncc == pytest.approx(2 / 100)
    assert split_bregman_cut(two_cliques(10), rng=rng).ncc == pytest.approx(1 / 91)
    assert split_bregman_cut(grid(20, 40), rng=rng).ncc == pytest.approx(20 / 400)


def test_one_start_leaves_the_surroundings_of_the_fiedler_vector() -> None:
    """On most graphs without symmetry the cut is no worse than what maximum flows make of the same start."""
    graphs_tried = [mesh_like(seed) for seed in range(10)]
    ours = [split_bregman_cut(graph, starts=1, rng=np.random.default_rng(0)).ncc for graph in graphs_tried]
    flows = [improve(graph, sweep(graph, fiedler_vectors(graph)[:, 0]).side).ncc for graph in graphs_tried]
    assert np.mean(np.array(ours) <= np.array(flows) * 1.001) >= 0.7


def test_the_flow_stops_when_the_cut_settles() -> None:
    graph = mesh_like(2)
    few, many = (
        split_bregman_cut(graph, starts=1, iterations=iterations, rng=np.random.default_rng(0))
        for iterations in (1000, 10**9)
    )
    assert (few.side == many.side).all()


def test_the_result_depends_on_nothing_but_the_graph_and_the_generator() -> None:
    graph = mesh_like(0)
    first, second = (split_bregman_cut(graph, starts=3, rng=np.random.default_rng(7)) for _ in range(2))
    assert (first.side == second.side).all()
