import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.graphs import all_sides, cuts, graphs
from segcore.arrays import FloatArray
from segcore.graphs.cheeger import balance_subgradient, cut_of
from segcore.graphs.surface_graph import SurfaceGraph
from segcore.solvers.inner_problem import InnerProblem


@st.composite
def problems(draw: st.DrawFn) -> tuple[SurfaceGraph, FloatArray]:
    """A graph and the supply of a step from some set of nodes."""
    graph = draw(graphs())
    side = np.array(draw(st.lists(st.booleans(), min_size=graph.node_count, max_size=graph.node_count)))
    side[0], side[-1] = True, False
    cut = cut_of(graph, side)
    return graph, cut.ncc * balance_subgradient(graph, cut)


@given(problems())
def test_the_duality_gap_bounds_what_any_set_gains_and_closes(case: tuple[SurfaceGraph, FloatArray]) -> None:
    graph, supply = case
    problem = InnerProblem.of(graph)
    problem.aim(supply)
    sides = all_sides(graph.node_count)
    gain = -(cuts(graph, sides) - sides @ problem.supply).min()
    scale = np.abs(supply).sum()
    for _ in range(4):
        assert problem.gap >= gain - 1e-9 * scale
        problem.advance(5)
    problem.advance(20_000)
    assert problem.gap <= gain + 1e-3 * scale


@given(problems(), st.integers(1, 12))
def test_the_iterations_are_those_of_accelerated_gradient_descent(
    case: tuple[SurfaceGraph, FloatArray], iterations: int
) -> None:
    """With dense matrices: extrapolate, step, clip to the capacities; restart if the momentum leads uphill."""
    graph, supply = case
    problem = InnerProblem.of(graph)
    problem.aim(supply)
    dual = problem.dual
    first = np.repeat(np.arange(graph.node_count), np.diff(dual.start))
    gradient = np.zeros((len(first), graph.node_count))
    gradient[np.arange(len(first)), first] = 1
    gradient[np.arange(len(first)), dual.other] = -1
    x = last = problem.flow.value.copy()
    t = 1.0
    for _ in range(iterations):
        next_t = (1 + np.sqrt(1 + 4 * t**2)) / 2
        y = x + (t - 1) / next_t * (x - last)
        r = (problem.supply - gradient.T @ y) / graph.volume
        t = next_t if r @ gradient.T @ (x - last) >= 0 else 1.0
        last, x = x, np.clip(y + dual.step * (gradient @ r), -dual.weight, dual.weight)
    problem.advance(iterations)
    np.testing.assert_allclose(problem.flow.value, x, atol=1e-9 * dual.weight.max())


@given(problems())
def test_the_solution_satisfies_the_optimality_conditions(case: tuple[SurfaceGraph, FloatArray]) -> None:
    """The flow is at capacity wherever r falls along an edge: <flow, grad r> = R(r)."""
    graph, supply = case
    problem = InnerProblem.of(graph)
    problem.aim(supply)
    problem.advance(20_000)
    r = problem.solution
    variation = graph.weight @ np.abs(r[graph.edges[:, 0]] - r[graph.edges[:, 1]])
    assert variation == pytest.approx(
        problem.flow.divergence @ r, abs=1e-3 * np.abs(supply).sum() * np.abs(r).max() + 1e-12
    )


@given(problems())
def test_the_flow_keeps_to_the_capacities_and_its_divergence_is_kept(case: tuple[SurfaceGraph, FloatArray]) -> None:
    graph, supply = case
    problem = InnerProblem.of(graph)
    for target in (supply, supply[::-1] - supply.mean()):
        problem.aim(target)
        problem.advance(7)
        assert (np.abs(problem.flow.value) <= problem.dual.weight).all()
        first = np.repeat(np.arange(graph.node_count), np.diff(problem.dual.start))
        leaving = np.bincount(first, problem.flow.value, graph.node_count)
        entering = np.bincount(problem.dual.other, problem.flow.value, graph.node_count)
        np.testing.assert_allclose(problem.flow.divergence, leaving - entering, atol=1e-9 * np.abs(supply).sum())
