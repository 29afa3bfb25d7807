"""The gradient flow of the ratio of total variation and balance, a relaxation of the Cheeger cut, p = 1."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numba import njit

from segcore.arrays import FloatArray
from segcore.graphs.cheeger import Cut, sweep
from segcore.graphs.laplacian import LaplacianFactor, factorise, substitute
from segcore.graphs.surface_graph import IndexArray, SurfaceGraph

TIME_STEP = 30.0  # of the flow, for functions of mean magnitude 1
FIRST_THRESHOLD = 0.3  # of the shrinkage, for the same


@dataclass(frozen=True, slots=True, eq=False)
class TotalVariationFlow:
    """The flow that lowers E(f) = R(f) / B(f), prepared for a graph.

    R(f) = sum of w[i, j] |f[i] - f[j]|, B(f) = sum vol[i] |f[i]| for functions of weighted median 0; the least E is the
    least normalized Cheeger cut, at the indicator of its side. A step, implicit in R and explicit in B, is

        minimise R(u) - E(f) <u, v> + E(f) / (2 c) sum of vol[i] (u[i] - f[i])^2, v = vol sign(f),

    by some split Bregman iterations, then back to median 0 and mean magnitude 1. In an iteration the differences along
    the edges are free, at a penalty k E(f): a linear system with the matrix D / c + k L, the same for all steps, takes
    turns with a shrinkage of the differences.

    References
    ----------
    Szlam and Bresson, Total variation and Cheeger cuts, ICML 2010; Bresson, Laurent, Uminsky and von Brecht,
    Convergence and energy landscape for Cheeger cut clustering, NIPS 2012 (the step); Goldstein and Osher, The split
    Bregman method for L1-regularized problems, SIAM J. Imaging Sciences 2, 2009.
    """

    graph: SurfaceGraph
    edges: IndexArray  # (E, 2)
    penalty: float  # k
    factor: LaplacianFactor  # of the matrix, as the Laplacian of a graph with one more node

    @classmethod
    def of(cls, graph: SurfaceGraph, values: FloatArray) -> "TotalVariationFlow":
        """The penalty is such that ``FIRST_THRESHOLD`` is the threshold of the shrinkage at this function."""
        penalty = 1 / (FIRST_THRESHOLD * _energy(graph, _centred(graph, values)))
        return cls(graph, graph.edges.view(np.uint32), penalty, factorise(_grounded(graph, penalty)))

    def cuts(self, values: FloatArray, iterations: int) -> Iterator[Cut]:
        """The sweep of a function, then that of the function after every step, for ever.

        Parameters
        ----------
        values : (N,) not constant.
        iterations : of split Bregman in a step.
        """
        graph = self.graph
        yield sweep(graph, values)
        f = _centred(graph, values)
        f *= _scale(graph, f)
        jump = f[graph.edges[:, 0]] - f[graph.edges[:, 1]]
        bregman = np.zeros_like(jump)
        while True:
            source = graph.volume * f / TIME_STEP + _subgradient(graph, f)
            threshold = 1 / (self.penalty * _energy(graph, f))
            f = _centred(graph, self._iterate(source, threshold, jump, bregman, iterations))
            scale = _scale(graph, f)
            f *= scale
            jump *= scale
            yield sweep(graph, f)

    def _iterate(
        self, source: FloatArray, threshold: float, jump: FloatArray, bregman: FloatArray, iterations: int
    ) -> FloatArray:
        factor = self.factor
        conductance = self.penalty * self.graph.weight
        arrays = (factor.order, factor.start, factor.row, factor.share, factor.pivot)
        return _split_bregman(self.edges, conductance, *arrays, source, threshold, jump, bregman, iterations)


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


@njit(cache=True)
def _split_bregman(  # type: ignore[no-untyped-def]
    edges, conductance, order, start, row, share, pivot, source, threshold, jump, bregman, iterations
):
    """u after some iterations; ``jump`` and ``bregman``, the free differences and their multipliers, go on from there.

    The linear system is (D / c + k L) u = source + div k w (jump - bregman); the last node takes up the sum, at 0.
    Then x, the difference of u plus the multiplier, is shrunk to the jump, and the multiplier is what is left of it.
    """
    node_count = len(source)
    u = np.zeros(node_count)
    b = np.empty(node_count + 1)
    for _ in range(iterations):
        total = 0.0
        for i in range(node_count):
            b[i] = source[i]
            total += source[i]
        b[node_count] = -total
        for e in range(len(edges)):
            flow = conductance[e] * (jump[e] - bregman[e])
            b[edges[e, 0]] += flow
            b[edges[e, 1]] -= flow
        potential = substitute(order, start, row, share, pivot, b)
        for i in range(node_count):
            u[i] = potential[i] - potential[node_count]
        for e in range(len(edges)):
            x = u[edges[e, 0]] - u[edges[e, 1]] + bregman[e]
            bregman[e] = min(max(x, -threshold), threshold)
            jump[e] = x - bregman[e]
    return u
