"""The second eigenvector of the graph p-Laplacian for 1 < p < 2."""

from collections import deque
from collections.abc import Iterator

import numpy as np

from segcore.array_kernels import dot
from segcore.arrays import FloatArray
from segcore.errors import InvalidParameters
from segcore.graphs.cheeger import Cut, sweep
from segcore.graphs.laplacian import LaplacianFactor, factorise, factorise_edges
from segcore.graphs.surface_graph import SurfaceGraph
from segcore.jit.decorators import kernel
from segcore.solvers.starts import start_functions

# MEMORY and SUFFICIENT_DECREASE are the usual values of L-BFGS and of the Armijo rule (Nocedal and Wright, Numerical
# optimization, 2006); the others were set by hand. CONTINUATION and LEAST_DECREASE are compared with their neighbours
# in bench/RESULTS.md, "Constants and their neighbours".
CONTINUATION = 0.7  # p - 1 of a stage, relative to that of the stage before
MEMORY = 10  # pairs of L-BFGS
SUFFICIENT_DECREASE = 1e-4  # of a step, relative to the first order
SHORTEST_STEP = 1e-6  # of the line search, relative to the Newton step
LEAST_DECREASE = 1e-6  # relative decrease of the quotient below which a stage ends
BALANCED = 1e-10  # relative imbalance of the pulls on the center c
SMALLEST_JUMP = 1e-5  # along an edge, relative to the largest, for the first Hessian


def p_laplacian_cut(
    graph: SurfaceGraph, *, p: float = 1.2, starts: int = 1, iterations: int = 100, rng: np.random.Generator
) -> Cut:
    """Return the best threshold of the second eigenvector of the p-Laplacian.

    The eigenvector minimises F(f) = R(f) / B(f),

        R(f) = sum of w[i, j] |f[i] - f[j]|^p, B(f) = min over c of sum vol[i] |f[i] - c|^p,

    and is followed through decreasing exponents from 2 down to p, each one starting at the minimum of the last. With a
    smaller exponent the best threshold is closer to the best normalized Cheeger cut, and there are more local minima.

    Parameters
    ----------
    graph : connected, at least two nodes.
    p : above 1 and below 2.
    starts : at least 1. The first one is the Fiedler vector, so that the result is never worse than its sweep; the
        others are random smooth functions.
    iterations : limit of the L-BFGS iterations at one exponent.

    Returns
    -------
    The cut, node 0 in S.

    Raises
    ------
    InvalidParameters
        If p is not between 1 and 2.
    ValueError
        If the graph is not connected.

    References
    ----------
    Buehler and Hein, Spectral clustering based on the graph p-Laplacian, ICML 2009.
    """
    if not 1 < p < 2:
        raise InvalidParameters(f"The exponent p must be above 1 and below 2, not {p}.")
    functions = start_functions(graph, factorise(graph), starts, rng)
    cuts = (cut for values in functions for cut in _continuation(graph, values, p, iterations))
    return min(cuts, key=lambda cut: cut.ncc).canonical


def rayleigh_quotient(graph: SurfaceGraph, values: FloatArray, p: float) -> tuple[float, FloatArray]:
    """Return F(f) and its gradient (N,) for a function that is not constant."""
    gradient = np.empty(graph.node_count)
    center = _center(values, graph.volume, p, BALANCED)
    return _quotient(graph.edges.view(np.uint32), graph.weight, graph.volume, values, center, p, gradient), gradient


def _continuation(graph: SurfaceGraph, values: FloatArray, p: float, iterations: int) -> Iterator[Cut]:
    """Yield the sweep of the start, then that of the minimum at every exponent."""
    yield sweep(graph, values)
    exponent = 2.0
    while exponent > p:
        exponent = max(p, 1 + CONTINUATION * (exponent - 1))
        values = minimise(graph, values, exponent, iterations)
        yield sweep(graph, values)


def minimise(graph: SurfaceGraph, values: FloatArray, p: float, iterations: int) -> FloatArray:
    """(N,) a local minimum of F by L-BFGS, from a function that is not constant.

    The first Hessian is the Laplacian with the weights w |f[i] - f[j]|^(p - 2), with which R is quadratic at the start.

    References
    ----------
    Liu and Nocedal, On the limited memory BFGS method for large scale optimization, Mathematical Programming 45, 1989.
    """
    f = values / np.abs(values).max()
    factor = factorise_edges(graph.edges, _quadratic_weights(graph, f, p), graph.node_count)
    value, gradient = rayleigh_quotient(graph, f, p)
    pairs: deque[tuple[FloatArray, FloatArray]] = deque(maxlen=MEMORY)
    for _ in range(iterations):
        direction = _newton_direction(factor, gradient, pairs)
        slope = dot(gradient, direction)
        step = 1.0
        trial, trial_gradient = rayleigh_quotient(graph, f + direction, p)
        while trial > value + SUFFICIENT_DECREASE * step * slope and step > SHORTEST_STEP:
            step *= 0.5
            trial, trial_gradient = rayleigh_quotient(graph, f + step * direction, p)
        if not trial < value * (1 - LEAST_DECREASE):
            break
        if dot(direction, trial_gradient - gradient) > 0:
            pairs.append((step * direction, trial_gradient - gradient))
        f = f + step * direction
        value, gradient = trial, trial_gradient
    return f


def _newton_direction(
    factor: LaplacianFactor, gradient: FloatArray, pairs: deque[tuple[FloatArray, FloatArray]]
) -> FloatArray:
    """(N,) minus the gradient times the inverse Hessian, which is L^+ updated by pairs of a step and its change."""
    rest = gradient.copy()
    shares = []
    for step, change in reversed(pairs):
        shares.append(dot(step, rest) / dot(step, change))
        rest -= shares[-1] * change
    direction = factor.solve(rest)
    if pairs:
        step, change = pairs[-1]
        direction *= dot(step, change) / dot(change, factor.solve(change))
    for (step, change), share in zip(pairs, reversed(shares), strict=True):
        direction += step * (share - dot(change, direction) / dot(step, change))
    return -direction


def _quadratic_weights(graph: SurfaceGraph, f: FloatArray, p: float) -> FloatArray:
    """(E,) the weights of the first Hessian."""
    jump = np.abs(f[graph.edges[:, 0]] - f[graph.edges[:, 1]])
    stiffness = np.maximum(jump / jump.max(), SMALLEST_JUMP) ** (p - 2)
    weights: FloatArray = graph.weight * stiffness
    return weights


@kernel
def _center(f, volume, p, balanced):  # type: ignore[no-untyped-def]
    """The c that minimises sum vol[i] |f[i] - c|^p: there the pulls of the values above and below c are equal.

    Newton's method, replaced by bisection if it leaves the bracket or does not halve the imbalance, as near a value,
    where its steps vanish. It ends if the imbalance is at most ``balanced`` times all pulls, or the bracket is empty.
    """
    low = f.min()
    high = f.max()
    c = 0.5 * (low + high)
    last_imbalance = np.inf
    while low < c < high:
        above = 0.0
        below = 0.0
        stiffness = 0.0
        for i in range(len(f)):
            distance = f[i] - c
            if distance != 0:
                pull = volume[i] * abs(distance) ** (p - 1)
                stiffness += pull / abs(distance)
                if distance > 0:
                    above += pull
                else:
                    below += pull
        imbalance = above - below
        if abs(imbalance) <= balanced * (above + below):
            break
        if imbalance > 0:
            low = c
        else:
            high = c
        newton = c + imbalance / ((p - 1) * stiffness)
        trusted = low < newton < high and abs(imbalance) <= 0.5 * last_imbalance
        c = newton if trusted else 0.5 * (low + high)
        last_imbalance = abs(imbalance)
    return c


@kernel
def _quotient(edges, weight, volume, f, center, p, gradient):  # type: ignore[no-untyped-def]
    """Return R / B and fill its gradient (N,); the gradient of B is that at a fixed c, because c is optimal.

    The pulls on c are in balance. For p near 1 the pull of the node nearest to c depends on the rounding of c; it is
    therefore set to minus the sum of the others.
    """
    balance = 0.0
    nearest = 0
    rest = 0.0
    for i in range(len(f)):
        distance = f[i] - center
        power = volume[i] * abs(distance) ** (p - 1)
        balance += power * abs(distance)
        gradient[i] = -power if distance > 0 else power
        rest += gradient[i]
        if abs(distance) < abs(f[nearest] - center):
            nearest = i
    gradient[nearest] -= rest
    variation = 0.0
    for e in range(len(edges)):
        jump = f[edges[e, 0]] - f[edges[e, 1]]
        variation += weight[e] * abs(jump) ** p
    quotient = variation / balance
    for i in range(len(f)):
        gradient[i] *= p * quotient / balance
    for e in range(len(edges)):
        jump = f[edges[e, 0]] - f[edges[e, 1]]
        force = p / balance * weight[e] * abs(jump) ** (p - 1)
        if jump < 0:
            force = -force
        gradient[edges[e, 0]] += force
        gradient[edges[e, 1]] -= force
    return quotient
