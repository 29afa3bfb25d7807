"""Eigenvectors of the graph Laplacian: the relaxation of the normalized cut, p = 2."""

from functools import cache
from math import frexp, sqrt

import numpy as np

from segcore.array_kernels import dot
from segcore.arrays import FloatArray
from segcore.graphs.laplacian import LaplacianFactor, factorise, substitute
from segcore.graphs.surface_graph import SurfaceGraph
from segcore.jit.decorators import inner_kernel, kernel
from segcore.solvers.tridiagonal import diagonalise

# Set by hand. TOLERANCE and CHECK_EVERY are compared with their neighbours in bench/RESULTS.md, "Constants and their
# neighbours".
TOLERANCE = 1e-5  # residual of an eigenvector of the pseudo-inverse of L, relative to its eigenvalue
MOST_STEPS = 250  # of Lanczos: eigenvalues that it does not separate are treated as equal
CHECK_EVERY = 3  # steps between tests of convergence, each of which solves a tridiagonal eigenproblem
EXHAUSTED = 1e-12  # relative norm of the next basis vector below which the Krylov space is invariant
LEAST_EXPONENT = -500  # of a pivot, to base 2: the squares of solutions stay below 2^1024, the end of the range
START_SEED = 20130717  # any seed: a random start has a component along every eigenvector
_NOISE = 4096  # random numbers, at least
_SHIFT = 389  # between the parts of them from which the iteration starts and goes on


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
    return np.ascontiguousarray(eigenvectors_of(graph, factor, start_noise(graph.node_count), count).T)


def start_noise(node_count: int) -> FloatArray:
    """(M,) the random numbers from which Lanczos starts, M >= node_count."""
    length = _NOISE
    while length < node_count:
        length *= 2
    return _noise(length)


@cache
def _noise(length: int) -> FloatArray:
    return np.random.default_rng(START_SEED).standard_normal(length)


@kernel
def eigenvectors_of(graph: SurfaceGraph, factor: LaplacianFactor, noise: FloatArray, count: int) -> FloatArray:
    """(min(count, N - 1), N) ``fiedler_vectors`` of a connected graph, as rows, from random numbers."""
    root_volume = np.sqrt(graph.volume)
    vectors = _lanczos(factor, root_volume, noise, min(count, len(root_volume) - 1))
    for vector in vectors:
        largest = 0
        for i in range(len(vector)):
            vector[i] /= root_volume[i]
            if abs(vector[i]) > abs(vector[largest]):
                largest = i
        if vector[largest] < 0.0:
            for i in range(len(vector)):
                vector[i] = -vector[i]
    return vectors


@inner_kernel
def _lanczos(factor, root_volume, noise, count):  # type: ignore[no-untyped-def]
    """(count, N) eigenvectors of D^1/2 L^+ D^1/2 orthogonal to the constant functions, largest eigenvalue first.

    Lanczos with full orthogonalisation, against the constant function too. If the Krylov space is invariant, the
    iteration goes on from a new random vector.
    """
    node_count = len(root_volume)
    steps = min(MOST_STEPS, node_count - 1)
    factor = _in_range(factor)
    basis = np.empty((steps + 1, node_count))  # orthonormal rows
    length = sqrt(dot(root_volume, root_volume))
    for i in range(node_count):
        basis[0, i] = root_volume[i] / length
    diagonal = np.empty(steps)
    beside = np.empty(steps)
    image = noise[:node_count].copy()
    _orthogonalise(image, basis[:1])
    for step in range(1, steps + 1):
        image, diagonal[step - 1], beside[step - 1], exhausted = _advance(factor, root_volume, basis, step, image)
        if exhausted:
            for i in range(node_count):
                image[i] = noise[(i + _SHIFT * step) % len(noise)]
            _orthogonalise(image, basis[: step + 1])
        elif step < steps and (step <= count or step % CHECK_EVERY != 0):
            continue
        if step == steps or (not exhausted and _has_converged(diagonal[:step], beside[:step], count)):
            break
    return _combined(diagonal[:step], beside[:step], basis, count)


@inner_kernel
def _in_range(factor):  # type: ignore[no-untyped-def]
    """The factor times a power of two, which changes no digit, if squares of solutions would leave the range."""
    order, start, row, share, pivot = factor
    least = 1.0
    for value in pivot:
        if value > 0.0:
            least = min(least, value)
    exponent = frexp(least)[1]
    if exponent < LEAST_EXPONENT:
        pivot = pivot * 2.0 ** (LEAST_EXPONENT - exponent)
    return LaplacianFactor(order, start, row, share, pivot)


@inner_kernel
def _largest(values, count):  # type: ignore[no-untyped-def]
    """(min(count, N),) the places of the largest numbers (N,), the largest first."""
    chosen = np.empty(min(count, len(values)), dtype=np.int64)
    for k in range(len(chosen)):
        best = -1
        for i in range(len(values)):
            if best < 0 or values[i] > values[best]:
                is_free = True
                for j in range(k):
                    is_free = is_free and chosen[j] != i
                if is_free:
                    best = i
        chosen[k] = best
    return chosen


@inner_kernel
def _has_converged(diagonal, beside, count):  # type: ignore[no-untyped-def]
    """Whether the residuals of the eigenvectors of the largest eigenvalues are below the tolerance."""
    steps = len(diagonal)
    values, last = diagonal.copy(), np.zeros((1, steps))
    last[0, steps - 1] = 1.0
    diagonalise(values, beside.copy(), last)
    has_converged = True
    for k in _largest(values, count):
        has_converged = has_converged and beside[steps - 1] * abs(last[0, k]) <= TOLERANCE * values[k]
    return has_converged


@inner_kernel
def _combined(diagonal, beside, basis, count):  # type: ignore[no-untyped-def]
    """(count, N) the eigenvectors of the largest eigenvalues in the space of the rows of the basis after the first."""
    steps = len(diagonal)
    values, mixture = diagonal.copy(), np.eye(steps)
    diagonalise(values, beside.copy(), mixture)
    vectors = np.zeros((count, basis.shape[1]))
    chosen = _largest(values, count)
    for row in range(count):
        for j in range(steps):
            share, direction = mixture[j, chosen[row]], basis[j + 1]
            for i in range(len(direction)):
                vectors[row, i] += share * direction[i]
    return vectors


@inner_kernel
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


@inner_kernel
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
