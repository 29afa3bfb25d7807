from itertools import islice

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.graphs import best_ncc, graphs, laplacian, mesh_like, two_cliques
from segcore.arrays import FloatArray
from segcore.graphs.cheeger import sweep
from segcore.graphs.surface_graph import SurfaceGraph
from segcore.solvers.fiedler import fiedler_vectors
from segcore.solvers.total_variation import TIME_STEP, SplitVariables, TotalVariationFlow, split_bregman_steps


@st.composite
def functions(draw: st.DrawFn) -> tuple[SurfaceGraph, FloatArray]:
    graph = draw(graphs())
    return graph, np.random.default_rng(draw(st.integers(0, 1000))).standard_normal(graph.node_count)


@given(functions())
def test_the_matrix_of_the_linear_systems_is_the_one_of_the_formula(case: tuple[SurfaceGraph, FloatArray]) -> None:
    graph, values = case
    flow = TotalVariationFlow.of(graph, values)
    matrix = np.diag(graph.volume) / TIME_STEP + flow.penalty * laplacian(graph)
    source = graph.volume * values
    potential = flow.system.factor.solve(np.append(source, -source.sum()))
    np.testing.assert_allclose(matrix @ (potential[:-1] - potential[-1]), source, atol=1e-8 * np.abs(source).max())


@given(functions(), st.integers(1, 12))
def test_the_iterations_are_those_of_the_formulas(case: tuple[SurfaceGraph, FloatArray], iterations: int) -> None:
    """Solve (D / c + k L) u = source + div k w (jump - multiplier) densely, then shrink the differences."""
    graph, values = case
    flow = TotalVariationFlow.of(graph, values)
    source, threshold = graph.volume * values, 0.3
    gradient = np.zeros((len(graph.edges), graph.node_count))
    gradient[np.arange(len(graph.edges)), graph.edges[:, 0]] = 1
    gradient[np.arange(len(graph.edges)), graph.edges[:, 1]] = -1
    jump, multiplier = gradient @ values, np.zeros(len(graph.edges))
    variables = SplitVariables(jump.copy(), multiplier.copy())
    found = split_bregman_steps(flow.system, source, threshold, variables, iterations)
    matrix = np.diag(graph.volume) / TIME_STEP + flow.penalty * laplacian(graph)
    for _ in range(iterations):
        u = np.linalg.solve(matrix, source + gradient.T @ (flow.penalty * graph.weight * (jump - multiplier)))
        x = gradient @ u + multiplier
        jump = np.sign(x) * np.maximum(np.abs(x) - threshold, 0)
        multiplier = x - jump
    scale = 1 + np.abs(u).max()
    np.testing.assert_allclose(found, u, atol=1e-8 * scale)
    np.testing.assert_allclose(variables.jump, jump, atol=1e-8 * scale)
    np.testing.assert_allclose(variables.multiplier, multiplier, atol=1e-8 * scale)


@given(functions(), st.integers(1, 12))
def test_no_cut_on_the_way_beats_the_best_one_and_the_first_is_the_sweep(
    case: tuple[SurfaceGraph, FloatArray], iterations: int
) -> None:
    graph, values = case
    cuts = list(islice(TotalVariationFlow.of(graph, values).cuts(values, iterations), 6))
    assert cuts[0].ncc == sweep(graph, values).ncc
    assert min(cut.ncc for cut in cuts) >= best_ncc(graph) * (1 - 1e-9)


@given(st.integers(0, 100))
def test_some_steps_better_the_cut_of_a_random_function(seed: int) -> None:
    graph = mesh_like(seed, 10, 14)
    values = np.random.default_rng(seed).standard_normal(graph.node_count)
    first, *others = islice(TotalVariationFlow.of(graph, values).cuts(values, 10), 10)
    assert min(cut.ncc for cut in others) < 0.5 * first.ncc


def test_the_best_cut_of_two_cliques_stays() -> None:
    graph = two_cliques(8)
    values = fiedler_vectors(graph)[:, 0]
    for cut in islice(TotalVariationFlow.of(graph, values).cuts(values, 5), 20):
        assert cut.ncc == pytest.approx(1 / 57)


def test_the_start_may_be_shifted_and_scaled() -> None:
    graph = mesh_like(1)
    values = fiedler_vectors(graph)[:, 0]
    flow = TotalVariationFlow.of(graph, values)
    for a, b in islice(zip(flow.cuts(values, 5), flow.cuts(64 * values + 3, 5), strict=False), 6):
        assert a.ncc == pytest.approx(b.ncc)
