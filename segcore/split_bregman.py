"""Total variation and split Bregman iterations, p = 1: the second solver of the paper."""

import numpy as np
from numba import njit

from segcore.arrays import FloatArray
from segcore.cheeger import Cut, sweep
from segcore.graph import SurfaceGraph
from segcore.laplacian import LaplacianFactor, factorise
from segcore.starts import start_functions

TIME_STEP = 30.0  # of the gradient flow, for functions of mean magnitude 1
FIRST_THRESHOLD = 0.1  # of the shrinkage, for the same
ITERATIONS_PER_STEP = 10  # split Bregman iterations on one step of the flow
PATIENCE = 5  # steps without a better cut


def split_bregman_cut(graph: SurfaceGraph, *, starts: int = 6, iterations: int = 1000, rng: np.random.Generator) -> Cut:
    """The best normalized Cheeger cut that total variation flow passes from several starts.

    The relaxation E(f) = R(f) / B(f), R(f) = sum of w[i, j] |f[i] - f[j]|, B(f) = sum vol[i] |f[i]| for functions whose
    weighted median is 0, has the same minimum as the Cheeger cut. A step of its gradient flow, implicit in R and
    explicit in B with v = vol sign(f), is

        minimise R(u) - E(f) <u, v> + E(f) / (2 c) sum of vol[i] (u[i] - f[i])^2

    by a few split Bregman iterations, each one linear system and one shrinkage of the differences along the edges, and
    back to median 0 and mean magnitude 1. Every step is thresholded. Nothing makes E fall in every step; a start ends
    when the cut was not bettered for some steps or the iterations are used up.

    Parameters
    ----------
    graph : connected, at least two nodes.
    starts : at least 1. The first one is the Fiedler vector, so that the result is never worse than its sweep; the
        others are random smooth functions.
    iterations : the most split Bregman iterations from one start.

    Raises
    ------
    ValueError
        Where the graph is not connected.

    References
    ----------
    Szlam and Bresson, Total variation and Cheeger cuts, ICML 2010; Bresson, Laurent, Uminsky and von Brecht,
    Convergence and energy landscape for Cheeger cut clustering, NIPS 2012 (the step); Goldstein and Osher, The split
    Bregman method for L1-regularized problems, SIAM J. Imaging Sciences 2, 2009.
    """
    functions = start_functions(graph, factorise(graph), starts, rng)
    return min((_flow(graph, values, iterations) for values in functions), key=lambda cut: cut.ncc)


def _flow(graph: SurfaceGraph, values: FloatArray, iterations: int) -> Cut:
    """The best cut of the functions that the flow passes.

    The penalty of the splitting is k E(f), which leaves one matrix, D / c + k L, for the linear systems of all steps.
    """
    f = _centred(graph, values)
    f *= _scale(graph, f)
    penalty = 1 / (FIRST_THRESHOLD * _energy(graph, f))
    factor = factorise(_grounded(graph, penalty))
    edges = graph.edges.view(np.uint32)
    jump = f[graph.edges[:, 0]] - f[graph.edges[:, 1]]
    bregman = np.zeros_like(jump)
    best = sweep(graph, values)
    since = 0
    for _ in range(0, iterations, ITERATIONS_PER_STEP):
        source = graph.volume * f / TIME_STEP + _subgradient(graph, f)
        threshold = 1 / (penalty * _energy(graph, f))
        for _ in range(ITERATIONS_PER_STEP):
            f = _solve(factor, source + penalty * _divergence(edges, graph.weight, jump, bregman, len(f)))
            _shrink(edges, f, threshold, jump, bregman)
        f = _centred(graph, f)
        scale = _scale(graph, f)
        f *= scale
        jump *= scale
        cut = sweep(graph, f)
        since = 0 if cut.ncc < best.ncc else since + 1
        best = min(best, cut, key=lambda cut: cut.ncc)
        if since == PATIENCE:
            break
    return best


def _centred(graph: SurfaceGraph, values: FloatArray) -> FloatArray:
    """Less the weighted median."""
    order = np.argsort(values)
    below = np.cumsum(graph.volume[order])
    return values - values[order[np.searchsorted(below, 0.5 * below[-1])]]


def _scale(graph: SurfaceGraph, f: FloatArray) -> float:
    """The factor that makes the mean magnitude 1."""
    return float(graph.total_volume / (graph.volume @ np.abs(f)))


def _energy(graph: SurfaceGraph, f: FloatArray) -> float:
    """E(f) = R(f) / B(f) of a function of median 0."""
    variation = graph.weight @ np.abs(f[graph.edges[:, 0]] - f[graph.edges[:, 1]])
    return float(variation / (graph.volume @ np.abs(f)))


def _subgradient(graph: SurfaceGraph, f: FloatArray) -> FloatArray:
    """(N,): vol sign(f), and where f = 0 what makes the sum 0."""
    subgradient = graph.volume * np.sign(f)
    zero = f == 0
    subgradient[zero] = -graph.volume[zero] * (subgradient.sum() / graph.volume[zero].sum())
    return subgradient


def _grounded(graph: SurfaceGraph, penalty: float) -> SurfaceGraph:
    """The graph whose Laplacian is D / c + penalty L but for the last row, that of one more node next to all."""
    nodes = np.arange(graph.node_count, dtype=np.int32)
    spokes = np.stack([nodes, np.full_like(nodes, graph.node_count)], axis=1)
    edges = np.concatenate([graph.edges, spokes])
    weight = np.concatenate([penalty * graph.weight, graph.volume / TIME_STEP])
    return SurfaceGraph(edges, weight, np.ones(graph.node_count + 1))


def _solve(factor: LaplacianFactor, source: FloatArray) -> FloatArray:
    """f with (D / c + penalty L) f = source: the last node takes up the sum and is at 0."""
    potential = factor.solve(np.append(source, -source.sum()))
    return potential[:-1] - potential[-1]


@njit(cache=True)
def _divergence(edges, weight, jump, bregman, node_count):  # type: ignore[no-untyped-def]
    """(N,): the sum of w (jump - bregman) over the edges that start at a node less that over those that end there."""
    divergence = np.zeros(node_count)
    for e in range(len(edges)):
        flow = weight[e] * (jump[e] - bregman[e])
        divergence[edges[e, 0]] += flow
        divergence[edges[e, 1]] -= flow
    return divergence


@njit(cache=True)
def _shrink(edges, f, threshold, jump, bregman):  # type: ignore[no-untyped-def]
    """jump = shrink(x, threshold) and bregman = x - jump, where x is the jump of f plus the old ``bregman``."""
    for e in range(len(edges)):
        x = f[edges[e, 0]] - f[edges[e, 1]] + bregman[e]
        bregman[e] = min(max(x, -threshold), threshold)
        jump[e] = x - bregman[e]
