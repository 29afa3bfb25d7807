import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from helpers.graphs import best_ncc, cycle, graphs, grid, mesh_like, path, two_cliques
from segcore.arrays import FloatArray
from segcore.graphs.cheeger import balance_subgradient, sweep
from segcore.graphs.surface_graph import SurfaceGraph
from segcore.solvers.fiedler import fiedler_vectors
from segcore.solvers.inner_problem import InnerProblem
from segcore.solvers.inverse_power import inverse_power_cut


def functional(graph: SurfaceGraph, values: FloatArray) -> float:
    """F(f) = R(f) / B(f); the best c in B is a weighted median, one of the values."""
    variation = graph.weight @ np.abs(values[graph.edges[:, 0]] - values[graph.edges[:, 1]])
    balance = min(graph.volume @ np.abs(values - c) for c in values)
    return float(variation / balance)


@given(st.integers(0, 200))
def test_a_step_never_raises_the_functional(seed: int) -> None:
    """F at the thresholded solution is at most F at the solution, and that is at most F before the step."""
    graph = mesh_like(seed, 8, 12)
    rng = np.random.default_rng(seed)
    cut = sweep(graph, rng.standard_normal(graph.node_count))
    problem = InnerProblem.of(graph)
    problem.aim(cut.ncc * balance_subgradient(graph, cut))
    problem.advance(3000)
    assume(problem.gap > 1e-3 * cut.weight)  # if no step lowers F, the solution is 0 up to rounding
    after = functional(graph, problem.solution)
    assert after <= cut.ncc * (1 + 1e-9)
    assert functional(graph, sweep(graph, problem.solution).side.astype(float)) <= after * (1 + 1e-9)
    assert functional(graph, cut.side.astype(float)) == pytest.approx(cut.ncc)


@given(graphs(), st.integers(1, 4), st.integers(1, 300))
def test_the_cut_is_between_the_best_one_and_the_sweep_of_the_fiedler_vector(
    graph: SurfaceGraph, starts: int, iterations: int
) -> None:
    cut = inverse_power_cut(graph, starts=starts, iterations=iterations, rng=np.random.default_rng(0))
    swept = sweep(graph, fiedler_vectors(graph)[:, 0])
    assert best_ncc(graph) * (1 - 1e-9) <= cut.ncc <= swept.ncc


@given(graphs())
def test_a_few_starts_find_the_best_cut_of_most_small_graphs(graph: SurfaceGraph) -> None:
    cut = inverse_power_cut(graph, starts=6, rng=np.random.default_rng(0))
    assert cut.ncc <= best_ncc(graph) * 1.25


def test_closed_forms() -> None:
    rng = np.random.default_rng(0)
    assert inverse_power_cut(path(101), rng=rng).ncc == pytest.approx(1 / 99)
    assert inverse_power_cut(cycle(100), rng=rng).ncc == pytest.approx(2 / 100)
    assert inverse_power_cut(two_cliques(10), rng=rng).ncc == pytest.approx(1 / 91)
    assert inverse_power_cut(grid(20, 40), rng=rng).ncc == pytest.approx(20 / 400)


def test_the_result_depends_on_nothing_but_the_graph_and_the_generator() -> None:
    graph = mesh_like(0)
    first, second = (inverse_power_cut(graph, rng=np.random.default_rng(7)) for _ in range(2))
    assert (first.side == second.side).all()


def test_more_starts_are_never_worse() -> None:
    graph = mesh_like(1)
    values = [inverse_power_cut(graph, starts=starts, rng=np.random.default_rng(0)).ncc for starts in (1, 3, 9)]
    assert values == sorted(values, reverse=True)
