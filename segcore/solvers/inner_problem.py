"""The inner problem of the inverse power method for the 1-Laplacian, in its dual form on the edges."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from segcore.array_kernels import dot
from segcore.arrays import FloatArray
from segcore.graphs.laplacian import LaplacianFactor, factorise
from segcore.graphs.surface_graph import IndexArray, SurfaceGraph
from segcore.jit.decorators import kernel


class DualProblem(NamedTuple):
    """The constant part of the dual problem; edges are sorted by their first node."""

    start: IndexArray  # (N + 1,) node i is the first one of the edges start[i]..start[i + 1]
    other: IndexArray  # (E,) the second node
    weight: FloatArray  # (E,) capacity of the flow
    step: FloatArray  # (E,) step length of the gradient descent
    volume: FloatArray  # (N,)


class Flow(NamedTuple):
    """A flow on the edges and its divergence, now and before the last iteration, changed in place."""

    value: FloatArray  # (E,) from the first to the second node
    last_value: FloatArray  # (E,)
    divergence: FloatArray  # (N,) flow out of every node
    last_divergence: FloatArray  # (N,)


@dataclass(slots=True, eq=False)
class InnerProblem:
    """The inner problem in its dual form, solved by FISTA.

    For a supply b = F(f) v, whose sum is 0, the dual is to find the flow x, |x[e]| <= w[e], whose divergence is nearest
    to it:

        minimise sum of r[i]^2 vol[i], r = (b - div x) / vol;

    r, scaled to the unit ball, solves the inner problem. The dual value of the same problem over 0 <= g <= 1 is
    -sum of vol[i] max(r[i], 0), and 0 is the value of g = 0: ``gap`` is the difference.

    The flow is kept when the supply changes, as a warm start for the next problem, also for that of another start.

    References
    ----------
    Beck and Teboulle, A fast iterative shrinkage-thresholding algorithm for linear inverse problems, SIAM J. Imaging
    Sciences 2, 2009; O'Donoghue and Candes, Adaptive restart for accelerated gradient schemes, Found. Comput. Math. 15,
    2015.
    """

    graph: SurfaceGraph
    factor: LaplacianFactor
    dual: DualProblem
    supply: FloatArray  # (N,)
    flow: Flow
    momentum: float  # the sequence t_k of FISTA

    @classmethod
    def of(cls, graph: SurfaceGraph) -> "InnerProblem":
        """Prepare the problem with supply 0 and flow 0.

        The Hessian of half the dual in alpha = x / w is A^T diag(1 / vol) A, A[i, e] = +-w[e]. Two bounds of it are the
        number 2 max_i sum_j w[i, j]^2 / vol[i], as in the paper, and the diagonal matrix of its absolute row sums,
        w[e] (q[i] + q[j]) with q = degree / volume. The second one, used here, gives every edge its own step length.
        """
        order = np.argsort(graph.edges[:, 0], kind="stable")
        first, second = graph.edges[order].T
        weight = graph.weight[order]
        start = np.zeros(graph.node_count + 1, dtype=np.uint32)
        start[1:] = np.cumsum(np.bincount(first, minlength=graph.node_count))
        q = graph.degrees() / graph.volume
        nodes, edges = np.zeros(graph.node_count), np.zeros(len(weight))
        return cls(
            graph=graph,
            factor=factorise(graph),
            dual=DualProblem(start, second.astype(np.uint32), weight, weight / (q[first] + q[second]), graph.volume),
            supply=nodes,
            flow=Flow(edges, edges.copy(), nodes.copy(), nodes.copy()),
            momentum=1.0,
        )

    def aim(self, supply: FloatArray) -> None:
        """Set another supply; add the electrical flow of the missing supply, clipped to the capacities.

        The sign of a supply does not matter to the method; the one that is nearer to the last supply is taken.
        """
        self.supply = supply if dot(supply, self.supply) >= 0 else -supply
        potential = self.factor.solve(self.supply - self.flow.divergence)
        _add_flow(self.dual, potential, self.flow)
        self.momentum = 1.0

    def advance(self, iterations: int) -> None:
        """Continue FISTA for some iterations."""
        self.momentum = _fista(self.dual, self.supply, self.flow, self.momentum, iterations)

    @property
    def solution(self) -> FloatArray:
        """(N,) r, the solution of the inner problem up to scale."""
        return (self.supply - self.flow.divergence) / self.graph.volume

    @property
    def gap(self) -> float:
        """Upper bound of supply(A) - cut(A) over all sets A."""
        return float(np.maximum(self.supply - self.flow.divergence, 0).sum())


@kernel
def _add_flow(dual, potential, flow):  # type: ignore[no-untyped-def]
    """Add the flow of a potential, clip the sum to the capacities, and forget the last iteration."""
    start, other, weight = dual.start, dual.other, dual.weight
    value, divergence = flow.value, flow.divergence
    for i in range(len(divergence)):
        divergence[i] = 0.0
    for i in range(len(divergence)):
        for e in range(start[i], start[i + 1]):
            j = other[e]
            added = value[e] + weight[e] * (potential[i] - potential[j])
            value[e] = min(max(added, -weight[e]), weight[e])
            divergence[i] += value[e]
            divergence[j] -= value[e]
    flow.last_value[:] = value
    flow.last_divergence[:] = divergence


@kernel
def _fista(dual, supply, flow, t, iterations):  # type: ignore[no-untyped-def]
    """Accelerated projected gradient descent, restarted if the momentum leads uphill; returns the next t.

    The divergence of the extrapolated flow is extrapolated itself, so that an iteration runs over the edges once.
    """
    start, other, weight, step, volume = dual.start, dual.other, dual.weight, dual.step, dual.volume
    value, last_value = flow.value, flow.last_value
    divergence, last_divergence = flow.divergence, flow.last_divergence
    node_count = len(supply)
    r = np.empty(node_count)
    for _ in range(iterations):
        next_t = 0.5 * (1 + np.sqrt(1 + 4 * t * t))
        momentum = (t - 1) / next_t
        t = next_t
        downhill = 0.0
        for i in range(node_count):
            change = divergence[i] - last_divergence[i]
            r[i] = (supply[i] - divergence[i] - momentum * change) / volume[i]
            downhill += r[i] * change
            last_divergence[i] = divergence[i]
            divergence[i] = 0.0
        if downhill < 0:
            t = 1.0
        for i in range(node_count):
            leaving = 0.0
            for e in range(start[i], start[i + 1]):
                j = other[e]
                here = value[e]
                moved = here + momentum * (here - last_value[e]) + step[e] * (r[i] - r[j])
                last_value[e] = here
                value[e] = min(max(moved, -weight[e]), weight[e])
                leaving += value[e]
                divergence[j] -= value[e]
            divergence[i] += leaving
    return t
