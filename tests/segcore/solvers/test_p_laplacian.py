import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import eigh
from scipy.optimize import minimize_scalar

from helpers.graphs import all_sides, best_ncc, cuts, cycle, graphs, laplacian, mesh_like, path, two_cliques
from segcore.arrays import FloatArray
from segcore.errors import InvalidParameters
from segcore.graphs.cheeger import sweep
from segcore.graphs.surface_graph import SurfaceGraph
from segcore.solvers.fiedler import fiedler_vectors
from segcore.solvers.p_laplacian import minimise, p_laplacian_cut, rayleigh_quotient

exponents = st.floats(1.05, 1.95)


@st.composite
def functions(draw: st.DrawFn) -> tuple[SurfaceGraph, FloatArray]:
    graph = draw(graphs())
    return graph, np.random.default_rng(draw(st.integers(0, 1000))).standard_normal(graph.node_count)


@given(functions(), exponents)
def test_the_quotient_is_the_one_of_the_formula(case: tuple[SurfaceGraph, FloatArray], p: float) -> None:
    graph, f = case
    variation = graph.weight @ np.abs(f[graph.edges[:, 0]] - f[graph.edges[:, 1]]) ** p
    balance = minimize_scalar(lambda c: graph.volume @ np.abs(f - c) ** p, (f.min(), f.max()), tol=1e-12).fun
    assert rayleigh_quotient(graph, f, p)[0] == pytest.approx(variation / balance, rel=1e-6)


@given(functions(), st.floats(1.4, 1.95))  # below, the slope changes within the length of the step
def test_the_gradient_is_the_slope_and_scaling_or_shifting_changes_nothing(
    case: tuple[SurfaceGraph, FloatArray], p: float
) -> None:
    graph, f = case
    value, gradient = rayleigh_quotient(graph, f, p)
    assert gradient.sum() == pytest.approx(0, abs=1e-6 * (np.abs(gradient).max() + value))
    assert gradient @ f == pytest.approx(0, abs=1e-6 * (np.abs(gradient).max() + value))
    assert rayleigh_quotient(graph, 3 - 2 * f, p)[0] == pytest.approx(value, rel=1e-9)
    direction = np.random.default_rng(1).standard_normal(graph.node_count)
    h = 1e-7
    slope = (rayleigh_quotient(graph, f + h * direction, p)[0] - rayleigh_quotient(graph, f - h * direction, p)[0]) / (
        2 * h
    )
    assert slope == pytest.approx(gradient @ direction, rel=0.02, abs=0.02 * np.abs(gradient).max() + 1e-7 * value)


@given(functions(), exponents)
def test_descending_never_raises_the_quotient(case: tuple[SurfaceGraph, FloatArray], p: float) -> None:
    graph, f = case
    before = rayleigh_quotient(graph, f, p)[0]
    assert rayleigh_quotient(graph, minimise(graph, f, p, 20), p)[0] <= before * (1 + 1e-9)


@given(functions())
def test_at_two_any_start_descends_to_the_second_eigenvalue(case: tuple[SurfaceGraph, FloatArray]) -> None:
    graph, f = case
    value = rayleigh_quotient(graph, minimise(graph, f, 2.0, 200), 2.0)[0]
    second = eigh(laplacian(graph), np.diag(graph.volume), eigvals_only=True)[1]
    assert value == pytest.approx(second, rel=1e-2)


@given(graphs().filter(lambda graph: bool(np.allclose(graph.volume, graph.degrees()))), exponents)
def test_the_isoperimetric_inequalities_of_amghibech_hold(graph: SurfaceGraph, p: float) -> None:
    """2^(p - 1) (h / p)^p <= lambda_p <= 2^(p - 1) h, lambda_p being the least quotient."""
    sides = all_sides(graph.node_count)[1:-1]
    balance = np.minimum(sides @ graph.volume, ~sides @ graph.volume)
    best = sides[np.argmin(cuts(graph, sides) / balance)]
    h = best_ncc(graph)
    from_the_best_cut = rayleigh_quotient(graph, minimise(graph, best.astype(float), p, 100), p)[0]
    from_the_fiedler_vector = rayleigh_quotient(graph, minimise(graph, fiedler_vectors(graph)[:, 0], p, 100), p)[0]
    least = min(from_the_best_cut, from_the_fiedler_vector)
    assert 2 ** (p - 1) * (h / p) ** p <= least * (1 + 1e-6)
    assert least <= 2 ** (p - 1) * h * (1 + 1e-6)


@given(graphs(), exponents)
def test_the_cut_is_between_the_best_one_and_the_sweep_of_the_fiedler_vector(graph: SurfaceGraph, p: float) -> None:
    cut = p_laplacian_cut(graph, p=p, starts=2, iterations=20, rng=np.random.default_rng(0))
    assert best_ncc(graph) * (1 - 1e-9) <= cut.ncc <= sweep(graph, fiedler_vectors(graph)[:, 0]).ncc


def test_closed_forms() -> None:
    rng = np.random.default_rng(0)
    assert p_laplacian_cut(path(101), rng=rng).ncc == pytest.approx(1 / 99)
    assert p_laplacian_cut(cycle(100), rng=rng).ncc == pytest.approx(2 / 100)
    assert p_laplacian_cut(two_cliques(10), rng=rng).ncc == pytest.approx(1 / 91)


def test_the_cut_gets_better_as_the_exponent_falls() -> None:
    graphs_tried = [mesh_like(seed) for seed in range(8)]
    means = [
        np.mean([p_laplacian_cut(graph, p=p, rng=np.random.default_rng(0)).ncc for graph in graphs_tried])
        for p in (1.9, 1.5, 1.1)
    ]
    assert means == sorted(means, reverse=True)


@pytest.mark.parametrize("p", [1.0, 2.0, 0.0, float("nan")])
def test_exponents_out_of_range_are_refused(p: float) -> None:
    with pytest.raises(InvalidParameters, match="above 1 and below 2"):
        p_laplacian_cut(path(3), p=p, rng=np.random.default_rng(0))
