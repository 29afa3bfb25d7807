"""The gradient flow of the ratio of total variation and balance, a relaxation of the Cheeger cut, p = 1."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from segcore.array_kernels import dot
from segcore.arrays import FloatArray
from segcore.graphs.cheeger import Cut, sweep
from segcore.graphs.laplacian import LaplacianFactor, factorise_edges, substitute
from segcore.graphs.surface_graph import IndexArray, SurfaceGraph
from segcore.jit.decorators import kernel

# Set by hand, and compared with their neighbours in bench/RESULTS.md, "Constants and their neighbours".
TIME_STEP = 30.0  # of the flow, for functions of mean magnitude 1
FIRST_THRESHOLD = 0.3  # of the shrinkage, for the same


class SplitSystem(NamedTuple):
    """The linear system of the split Bregman iterations, the same in all steps."""

    edges: IndexArray  # (E, 2)
    conductance: FloatArray  # (E,) penalty k times weight
    factor: LaplacianFactor  # of the matrix D / c + k L, as the Laplacian of a graph with one more node


class SplitVariables(NamedTuple):
    """The state of the split Bregman iterations, changed in place."""

    jump: FloatArray  # (E,) the free differences along the edges
    multiplier: FloatArray  # (E,) their multipliers


@dataclass(frozen=True, slots=True, eq=False)
class TotalVariationFlow:
    """The flow that decreases E(f) = R(f) / B(f), prepared for a graph.

    R(f) = sum of w[i, j] |f[i] - f[j]|, B(f) = sum vol[i] |f[i]| for functions of weighted median 0; the least E is the
    least normalized Cheeger cut, at the indicator of its side. A step, implicit in R and explicit in B, is

        minimise R(u) - E(f) <u, v> + E(f) / (2 c) sum of vol[i] (u[i] - f[i])^2, v = vol sign(f),

    approximated by some split Bregman iterations and followed by a shift to median 0 and a scaling to mean magnitude 1.
    The iterations replace the differences along the edges by free variables with the penalty k E(f). They alternate a
    linear system with the matrix D / c + k L, the same for all steps, with a shrinkage of the differences.

    References
    ----------
    Szlam and Bresson, Total variation and Cheeger cuts, ICML 2010; Bresson, Laurent, Uminsky and von Brecht,
    Convergence and energy landscape for Cheeger cut clustering, NIPS 2012 (the step); Goldstein and Osher, The split
    Bregman method for L1-regularized problems, SIAM J. Imaging Sciences 2, 2009.
    """

    graph: SurfaceGraph
    total_volume: float
    penalty: float  # k
    system: SplitSystem

    @classmethod
    def of(cls, graph: SurfaceGraph, values: FloatArray) -> "TotalVariationFlow":
        """Choose the penalty for which ``FIRST_THRESHOLD`` is the threshold of the shrinkage at this function."""
        penalty = 1 / (FIRST_THRESHOLD * _energy(graph, _centred(graph, values)))
        conductance = penalty * graph.weight
        factor = _grounded_factor(graph, conductance)
        return cls(graph, graph.total_volume, penalty, SplitSystem(graph.edges.view(np.uint32), conductance, factor))

    def cuts(self, values: FloatArray, iterations: int) -> Iterator[Cut]:
        """Yield the sweep of a function, then that of the function after every step, without end.

        Parameters
        ----------
        values : (N,) not constant.
        iterations : split Bregman iterations in a step.
        """
        graph = self.graph
        yield sweep(graph, values)
        f = _centred(graph, values)
        f *= self._scale(f)
        jump = f[graph.edges[:, 0]] - f[graph.edges[:, 1]]
        variables = SplitVariables(jump, np.zeros_like(jump))
        while True:
            source = graph.volume * f / TIME_STEP + _subgradient(graph, f)
            threshold = 1 / (self.penalty * _energy(graph, f))
            f = _centred(graph, split_bregman_steps(self.system, source, threshold, variables, iterations))
            scale = self._scale(f)
            f *= scale
            jump *= scale
            yield sweep(graph, f)

    def _scale(self, f: FloatArray) -> float:
        """The factor that makes the mean magnitude 1."""
        return float(self.total_volume / dot(self.graph.volume, np.abs(f)))


def _centred(graph: SurfaceGraph, values: FloatArray) -> FloatArray:
    """(N,) values minus their weighted median."""
    order = np.argsort(values)
    below = np.cumsum(graph.volume[order])
    return values - values[order[np.searchsorted(below, 0.5 * below[-1])]]


def _energy(graph: SurfaceGraph, f: FloatArray) -> float:
    """E(f) = R(f) / B(f) of a function with median 0."""
    variation = dot(graph.weight, np.abs(f[graph.edges[:, 0]] - f[graph.edges[:, 1]]))
    return float(variation / dot(graph.volume, np.abs(f)))


def _subgradient(graph: SurfaceGraph, f: FloatArray) -> FloatArray:
    """(N,) vol sign(f), and at the zeros of f the values that make the sum 0."""
    subgradient = graph.volume * np.sign(f)
    zero = f == 0
    subgradient[zero] = -graph.volume[zero] * (subgradient.sum() / graph.volume[zero].sum())
    return subgradient


def _grounded_factor(graph: SurfaceGraph, conductance: FloatArray) -> LaplacianFactor:
    """Factorise D / c + k L as a Laplacian of which the last row and column belong to one more node next to all."""
    nodes = np.arange(graph.node_count, dtype=np.int32)
    spokes = np.stack([nodes, np.full_like(nodes, graph.node_count)], axis=1)
    edges = np.concatenate([graph.edges, spokes])
    return factorise_edges(edges, np.concatenate([conductance, graph.volume / TIME_STEP]), graph.node_count + 1)


@kernel
def split_bregman_steps(system, source, threshold, variables, iterations):  # type: ignore[no-untyped-def]
    """(N,) u after some split Bregman iterations from the state in ``variables``, which they change.

    An iteration solves (D / c + k L) u = source + div k w (jump - multiplier); the right-hand side of the extra node
    makes the sum 0, and u is 0 there. Then x, the difference of u plus the multiplier, is shrunk to the jump, and the
    multiplier becomes the remainder.

    Parameters
    ----------
    source : (N,) right-hand side of the step.
    threshold : of the shrinkage, > 0.
    """
    edges, conductance = system.edges, system.conductance
    order, start, row, share, pivot = system.factor
    jump, multiplier = variables.jump, variables.multiplier
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
            flow = conductance[e] * (jump[e] - multiplier[e])
            b[edges[e, 0]] += flow
            b[edges[e, 1]] -= flow
        potential = substitute(order, start, row, share, pivot, b)
        for i in range(node_count):
            u[i] = potential[i] - potential[node_count]
        for e in range(len(edges)):
            x = u[edges[e, 0]] - u[edges[e, 1]] + multiplier[e]
            multiplier[e] = min(max(x, -threshold), threshold)
            jump[e] = x - multiplier[e]
    return u
