import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import eigh

from helpers.graphs import best_ncc, cycle, graph_of, graphs, laplacian, mesh_like, path, two_cliques
from segcore.arrays import FloatArray
from segcore.graphs.cheeger import sweep
from segcore.graphs.surface_graph import SurfaceGraph
from segcore.solvers.fiedler import fiedler_vectors


def rayleigh_quotients(graph: SurfaceGraph, vectors: FloatArray) -> FloatArray:
    quotients: FloatArray = np.diag(vectors.T @ laplacian(graph) @ vectors) / (graph.volume @ vectors**2)
    return quotients


def dense_eigenvalues(graph: SurfaceGraph) -> FloatArray:
    eigenvalues: FloatArray = eigh(laplacian(graph), np.diag(graph.volume), eigvals_only=True)
    return eigenvalues


@given(graphs(), st.integers(1, 4))
def test_the_vectors_are_eigenvectors_and_the_first_belongs_to_the_second_eigenvalue(
    graph: SurfaceGraph, count: int
) -> None:
    vectors = fiedler_vectors(graph, count)
    eigenvalues = rayleigh_quotients(graph, vectors)
    assert vectors.shape == (graph.node_count, min(count, graph.node_count - 1))
    residual = laplacian(graph) @ vectors - graph.volume[:, None] * vectors * eigenvalues
    assert np.abs(residual).max() <= 1e-3 * dense_eigenvalues(graph)[-1] * np.abs(graph.volume[:, None] * vectors).max()
    assert eigenvalues[0] == pytest.approx(dense_eigenvalues(graph)[1], rel=1e-6)
    gram = vectors.T @ (graph.volume[:, None] * vectors)
    np.testing.assert_allclose(gram, np.eye(len(gram)), atol=1e-9)
    np.testing.assert_allclose(graph.volume @ vectors, 0, atol=1e-9 * graph.volume.sum())


@pytest.mark.slow
@given(st.integers(0, 1000))
def test_the_first_eigenvalues_are_those_of_the_dense_solver(seed: int) -> None:
    graph = mesh_like(seed, 12, 17)
    eigenvalues = rayleigh_quotients(graph, fiedler_vectors(graph, 4))
    np.testing.assert_allclose(eigenvalues, dense_eigenvalues(graph)[1:5], rtol=1e-6)


@given(graphs().filter(lambda graph: bool(np.allclose(graph.volume, graph.degrees()))))
def test_the_isoperimetric_inequalities_hold(graph: SurfaceGraph) -> None:
    """h^2 / 2 <= lambda_2 <= 2 h, and the sweep is at most sqrt(2 lambda_2): Cheeger."""
    second = rayleigh_quotients(graph, fiedler_vectors(graph))[0]
    h = best_ncc(graph)
    rounding = 1 + 1e-6
    assert h**2 / 2 <= second * rounding
    assert second <= 2 * h * rounding
    assert h <= sweep(graph, fiedler_vectors(graph)[:, 0]).ncc * rounding
    assert sweep(graph, fiedler_vectors(graph)[:, 0]).ncc <= np.sqrt(2 * second) * rounding


def test_closed_forms() -> None:
    """lambda_2 = 1 - cos(pi / (N - 1)) on a path and 1 - cos(2 pi / N) on a cycle, volumes being degrees."""
    assert rayleigh_quotients(path(50), fiedler_vectors(path(50)))[0] == pytest.approx(1 - np.cos(np.pi / 49), rel=1e-9)
    assert rayleigh_quotients(cycle(50), fiedler_vectors(cycle(50)))[0] == pytest.approx(
        1 - np.cos(2 * np.pi / 50), rel=1e-9
    )


def test_a_weak_edge_between_two_cliques_is_found_at_any_weight() -> None:
    for bridge in (1e-3, 1e-9, 1e-15, 1e-160, 3e-309):
        vector = fiedler_vectors(two_cliques(20, bridge))[:, 0]
        assert len(set(np.sign(vector[:20]))) == len(set(np.sign(vector[20:]))) == 1
        assert np.sign(vector[0]) != np.sign(vector[20])


def test_the_largest_entry_is_positive_and_the_result_always_the_same() -> None:
    graph = mesh_like(0)
    vectors = fiedler_vectors(graph, 3)
    assert (vectors.max(axis=0) == np.abs(vectors).max(axis=0)).all()
    assert (vectors == fiedler_vectors(graph, 3)).all()


def test_graphs_of_one_and_two_nodes() -> None:
    assert fiedler_vectors(graph_of([], [], np.ones(1))).shape == (1, 0)
    np.testing.assert_allclose(np.abs(fiedler_vectors(path(2))), np.sqrt(0.5) * np.ones((2, 1)))


def test_every_eigenvector_of_a_star_is_found_though_one_eigenvalue_repeats() -> None:
    star = graph_of([(0, i) for i in range(1, 9)])
    eigenvalues = rayleigh_quotients(star, fiedler_vectors(star, 8))
    np.testing.assert_allclose(eigenvalues, [1, 1, 1, 1, 1, 1, 1, 2], rtol=1e-9)


def test_a_graph_that_is_not_connected_is_refused() -> None:
    with pytest.raises(ValueError, match="not connected"):
        fiedler_vectors(graph_of([(0, 1), (2, 3)]))
