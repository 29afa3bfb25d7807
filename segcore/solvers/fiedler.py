"""Eigenvectors of the graph Laplacian: the relaxation of the normalized cut, p = 2."""

from math import frexp, sqrt

import numpy as np
from numba import njit
from scipy.linalg import eigh_tridiagonal

from segcore.array_kernels import dot
from segcore.arrays import FloatArray
from segcore.graphs.laplacian import LaplacianFactor, factorise, substitute
from segcore.graphs.surface_graph import SurfaceGraph

# Set by hand. TOLERANCE and CHECK_EVERY are compared with their neighbours in bench/RESULTS.md, "Constants and their
# neighbours".
TOLERANCE = 1e-5  # residual of an eigenvector of the pseudo-inverse of L, relative to its eigenvalue
MOST_STEPS = 250  # of Lanczos: eigenvalues that it does not separate are treated as equal
CHECK_EVERY = 3  # steps between tests of convergence, each of which solves a tridiagonal eigenproblem
EXHAUSTED = 1e-12  # relative norm of the next basis vector below which the Krylov space is invariant
LEAST_EXPONENT = -500  # of a pivot, to base 2: the squares of solutions stay below 2^1024, the end of the range
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

    No sum depends on the number of threads of BLAS: the products are kernels of Cleave, and LAPACK solves the
    tridiagonal problem by a method (MRRR) that only scales, copies and exchanges at most ``MOST_STEPS`` numbers by
    BLAS. The default method of SciPy, divide and conquer, multiplies matrices by BLAS.
    """
    node_count = len(root_volume)
    steps = min(MOST_STEPS, node_count - 1)
    rng = np.random.default_rng(START_SEED)
    factor = _in_range(factor)
    basis = np.empty((steps + 1, node_count))  # orthonormal rows
    basis[0] = root_volume / sqrt(dot(root_volume, root_volume))
    diagonal = np.empty(steps)
    beside = np.empty(steps)
    mixture: FloatArray = np.empty((0, 0))
    image = rng.standard_normal(node_count)
    _orthogonalise(image, basis[:1])
    for step in range(1, steps + 1):
        image, diagonal[step - 1], beside[step - 1], exhausted = _advance(factor, root_volume, basis, step, image)
        if exhausted:
            image = rng.standard_normal(node_count)
            _orthogonalise(image, basis[: step + 1])
        elif step < steps and (step <= count or step % CHECK_EVERY != 0):
            continue
        values, mixture = _largest_eigenpairs(diagonal[:step], beside[: step - 1], count)
        residual = beside[step - 1] * np.abs(mixture[-1])
        if not exhausted and (residual <= TOLERANCE * values).all():
            break
    eigenvectors: FloatArray = np.einsum("ji,jk->ik", mixture[:, ::-1], basis[1 : len(mixture) + 1])
    return eigenvectors


def _in_range(factor: LaplacianFactor) -> LaplacianFactor:
    """The factor times a power of two, which changes no digit, if squares of solutions would leave the range."""
    exponent = frexp(factor.pivot.min(where=factor.pivot > 0, initial=1.0))[1]
    return factor._replace(pivot=factor.pivot * 2.0 ** max(0, LEAST_EXPONENT - exponent))


def _largest_eigenpairs(diagonal: FloatArray, beside: FloatArray, count: int) -> tuple[FloatArray, FloatArray]:
    """(K,) the K = min(N, count) largest eigenvalues of a tridiagonal matrix, ascending, and (N, K) eigenvectors."""
    last = len(diagonal) - 1
    chosen = (max(0, last + 1 - count), last)
    values, vectors = eigh_tridiagonal(diagonal, beside, select="i", select_range=chosen, lapack_driver="stemr")
    return np.asarray(values, dtype=np.float64), np.asarray(vectors, dtype=np.float64)


@njit(cache=True)
def _advance(factor, root_volume, basis, step, image):  # type: ignore[no-untyped-def]
    """A step of Lanczos from an image, orthogonal to the rows of the basis before ``step``, which becomes that row.

    Returns
    -------
    The image of the new row, orthogonal to it and to all before; its coefficients along the new row and along the next
    one; and whether there is no next one, because nothing but rounding errors is left.
    """
    row = basis[step]
    length = sqrt(dot(image, image))
    for i in range(len(image)):
        row[i] = image[i] / length
    order, start, entry, share, pivot = factor
    image = root_volume * substitute(order, start, entry, share, pivot, root_volume * row)
    length = sqrt(dot(image, image))
    along = _orthogonalise(image, basis[: step + 1])
    beside = sqrt(dot(image, image))
    exhausted = beside <= EXHAUSTED * length
    return image, along, 0.0 if exhausted else beside, exhausted


@njit(cache=True)
def _orthogonalise(vector: FloatArray, basis: FloatArray) -> float:
    """Subtract from a vector, in place, its projection on orthonormal rows; return the coefficient of the last row."""
    last = 0.0
    coefficient = np.empty(len(basis))
    for _ in range(2):
        for j in range(len(basis)):
            coefficient[j] = dot(basis[j], vector)
        for j in range(len(basis)):
            row, c = basis[j], coefficient[j]
            for i in range(len(vector)):
                vector[i] -= c * row[i]
        last += coefficient[-1]
    return last
