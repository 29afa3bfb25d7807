"""Eigenvectors of the graph Laplacian: the relaxation of the normalized cut, p = 2."""

import numpy as np
from scipy.linalg import eigh_tridiagonal

from segcore.arrays import FloatArray
from segcore.graphs.laplacian import LaplacianFactor, factorise
from segcore.graphs.surface_graph import SurfaceGraph

TOLERANCE = 1e-5  # residual of an eigenvector of the pseudo-inverse of L, relative to its eigenvalue
MOST_STEPS = 250  # of Lanczos; eigenvalues that are not told apart by then are equal for every purpose here
CHECK_EVERY = 3  # steps
EXHAUSTED = 1e-12  # what is left of a vector, relatively, once the Krylov space is invariant
START_SEED = 20130717  # the start needs only a component along every eigenvector


def fiedler_vectors(graph: SurfaceGraph, count: int = 1) -> FloatArray:
    """The generalised eigenvectors L v = lambda D v after the constant one, D = diag(volume), smallest lambda first.

    The same graph always gives the same result. Of an eigenvalue that occurs m times, fewer than m eigenvectors may be
    found.

    Parameters
    ----------
    graph : connected.
    count : how many eigenvectors, at least 1.

    Returns
    -------
    (N, min(count, N - 1)), each of unit D-norm, its entry of largest magnitude positive.

    Raises
    ------
    ValueError
        Where the graph is not connected: its components are cuts of no cost, to be made first.
    """
    return eigenvectors(graph, factorise(graph), count)


def eigenvectors(graph: SurfaceGraph, factor: LaplacianFactor, count: int) -> FloatArray:
    """``fiedler_vectors`` where the factor of the graph's Laplacian is at hand."""
    if factor.component_count != 1:
        raise ValueError("The graph is not connected: cut its components apart first.")
    count = min(count, graph.node_count - 1)
    root_volume = np.sqrt(graph.volume)
    vectors = _lanczos(factor, root_volume, count) / root_volume
    largest = vectors[np.arange(count), np.abs(vectors).argmax(axis=1)]
    return np.ascontiguousarray((vectors * np.sign(largest)[:, None]).T)


def _lanczos(factor: LaplacianFactor, root_volume: FloatArray, count: int) -> FloatArray:
    """(count, N): eigenvectors of D^1/2 L^+ D^1/2 off the constant functions, largest eigenvalue first.

    With full orthogonalisation, against the constant function too; a Krylov space that is exhausted is continued in a
    new direction.
    """
    node_count = len(root_volume)
    steps = min(MOST_STEPS, node_count - 1)
    rng = np.random.default_rng(START_SEED)
    basis = np.empty((steps + 1, node_count))  # orthonormal rows
    basis[0] = root_volume / np.linalg.norm(root_volume)
    diagonal = np.empty(steps)
    beside = np.empty(steps)
    mixture: FloatArray = np.empty((0, 0))
    image = rng.standard_normal(node_count)
    _orthogonalise(image, basis[:1])
    for step in range(1, steps + 1):
        basis[step] = image / np.linalg.norm(image)
        image = root_volume * factor.solve(root_volume * basis[step])
        length = np.linalg.norm(image)
        diagonal[step - 1] = _orthogonalise(image, basis[: step + 1])
        beside[step - 1] = np.linalg.norm(image)
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


def _orthogonalise(vector: FloatArray, basis: FloatArray) -> float:
    """Take from a vector, in place, its part in the span of orthonormal rows; returns its coefficient of the last row.

    einsum, unlike the product operator, adds in an order that does not depend on the number of threads.
    """
    last = 0.0
    for _ in range(2):
        coefficients = np.einsum("ij,j->i", basis, vector)
        vector -= np.einsum("i,ij->j", coefficients, basis)
        last += float(coefficients[-1])
    return last
