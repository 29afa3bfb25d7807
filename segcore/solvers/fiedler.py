"""Eigenvectors of the graph Laplacian: the relaxation of the normalized cut, p = 2."""

from math import sqrt

import numpy as np
from scipy.linalg import eigh_tridiagonal

from segcore.arrays import FloatArray
from segcore.graphs.laplacian import LaplacianFactor, factorise
from segcore.graphs.surface_graph import SurfaceGraph

# Set by hand. TOLERANCE and CHECK_EVERY are compared with their neighbours in bench/RESULTS.md, "Constants and their
# neighbours".
TOLERANCE = 1e-5  # residual of an eigenvector of the pseudo-inverse of L, relative to its eigenvalue
MOST_STEPS = 250  # of Lanczos: eigenvalues that it does not separate are treated as equal
CHECK_EVERY = 3  # steps between tests of convergence, each of which solves a tridiagonal eigenproblem
EXHAUSTED = 1e-12  # relative norm of the next basis vector below which the Krylov space is invariant
START_SEED = 20130717  # any seed: a random start has a component along every eigenvector


def fiedler_vectors(graph: SurfaceGraph, count: int = 1) -> FloatArray:
    """Return the eigenvectors L v = lambda D v after the constant one, D = diag(volume), smallest lambda first.

    The same graph always gives the same result. If an eigenvalue has multiplicity m, fewer than m of its eigenvectors
    may be found.

    Parameters
    ----------
    graph : connected.
    count : how many eigenvectors, at least 1.

    Returns
    -------
    (N, min(count, N - 1)) columns of unit D-norm, the entry of largest magnitude positive.

    Raises
    ------
    ValueError
        If the graph is not connected: cuts between components cost nothing and must be made first.

    References
    ----------
    Shi and Malik, Normalized cuts and image segmentation, PAMI 22(8), 2000; Lanczos, An iteration method for the
    solution of the eigenvalue problem of linear differential and integral operators, J. Res. Nat. Bur. Stand. 45, 1950.
    """
    return eigenvectors(graph, factorise(graph), count)


def eigenvectors(graph: SurfaceGraph, factor: LaplacianFactor, count: int) -> FloatArray:
    """``fiedler_vectors`` of a graph whose Laplacian has been factorised."""
    if factor.component_count != 1:
        raise ValueError("The graph is not connected: cut its components apart first.")
    count = min(count, graph.node_count - 1)
    root_volume = np.sqrt(graph.volume)
    vectors = _lanczos(factor, root_volume, count) / root_volume
    largest = vectors[np.arange(count), np.abs(vectors).argmax(axis=1)]
    return np.ascontiguousarray((vectors * np.sign(largest)[:, None]).T)


def _lanczos(factor: LaplacianFactor, root_volume: FloatArray, count: int) -> FloatArray:
    """(count, N) eigenvectors of D^1/2 L^+ D^1/2 orthogonal to the constant functions, largest eigenvalue first.

    Lanczos with full orthogonalisation, against the constant function too. If the Krylov space is invariant, the
    iteration goes on from a new random vector.
    """
    node_count = len(root_volume)
    steps = min(MOST_STEPS, node_count - 1)
    rng = np.random.default_rng(START_SEED)
    basis = np.empty((steps + 1, node_count))  # orthonormal rows
    basis[0] = root_volume / _norm(root_volume)
    diagonal = np.empty(steps)
    beside = np.empty(steps)
    mixture: FloatArray = np.empty((0, 0))
    image = rng.standard_normal(node_count)
    _orthogonalise(image, basis[:1])
    for step in range(1, steps + 1):
        basis[step] = image / _norm(image)
        image = root_volume * factor.solve(root_volume * basis[step])
        length = _norm(image)
        diagonal[step - 1] = _orthogonalise(image, basis[: step + 1])
        beside[step - 1] = _norm(image)
        if beside[step - 1] <= EXHAUSTED * length:
            beside[step - 1] = 0.0
            image = rng.standard_normal(node_count)
            _orthogonalise(image, basis[: step + 1])
        elif step < steps and (step <= count or step % CHECK_EVERY != 0):
            continue
        values, ritz = eigh_tridiagonal(diagonal[:step], beside[: step - 1])
        mixture = np.asarray(ritz, dtype=np.float64)
        residual = beside[step - 1] * np.abs(mixture[-1, -count:])
        if beside[step - 1] > 0 and (residual <= TOLERANCE * values[-count:]).all():
            break
    eigenvectors: FloatArray = np.einsum("ji,jk->ik", mixture[:, : -count - 1 : -1], basis[1 : len(mixture) + 1])
    return eigenvectors


def _norm(vector: FloatArray) -> float:
    """The Euclidean norm; faster than ``np.linalg.norm`` for the short vectors of small segments."""
    return sqrt(vector.dot(vector))


def _orthogonalise(vector: FloatArray, basis: FloatArray) -> float:
    """Subtract from a vector, in place, its projection on orthonormal rows; return the coefficient of the last row.

    ``einsum``, unlike the matrix product, sums in an order that does not depend on the number of threads.
    """
    last = 0.0
    for _ in range(2):
        coefficients = np.einsum("ij,j->i", basis, vector)
        vector -= np.einsum("i,ij->j", coefficients, basis)
        last += float(coefficients[-1])
    return last
