"""The inner problem of the inverse power method for the 1-Laplacian, on the edge dual."""

from dataclasses import dataclass

import numpy as np
from numba import njit

from segcore.arrays import FloatArray
from segcore.graphs.laplacian import LaplacianFactor, factorise
from segcore.graphs.surface_graph import IndexArray, SurfaceGraph


@dataclass(slots=True, eq=False)
class InnerProblem:
    """The inner problem in its dual form, solved by FISTA.

    For a supply b = F(f) v, whose sum is 0, the dual is to find the flow x, |x[e]| <= w[e], that comes nearest to it:

        minimise sum of r[i]^2 vol[i], r = (b - div x) / vol;

    r, scaled to the unit ball, solves the inner problem. The dual value of the same problem over 0 <= g <= 1 is
    -sum of vol[i] max(r[i], 0), and 0 is the value of g = 0: ``gap`` is the difference.

    The flow stays when the supply changes: it warms up every problem but the first, that of another start included.

    References
    ----------
    Beck and Teboulle, A fast iterative shrinkage-thresholding algorithm for linear inverse problems, SIAM J. Imaging
    Sciences 2, 2009; O'Donoghue and Candes, Adaptive restart for accelerated gradient schemes, Found. Comput. Math. 15,
    2015.
    """

    graph: SurfaceGraph
    factor: LaplacianFactor
    start: IndexArray  # (N + 1,) edges sorted by their first node: those of node i are start[i]..start[i + 1]
    other: IndexArray  # (E,) the second node
    weight: FloatArray  # (E,)
    step: FloatArray  # (E,) of the gradient descent
    supply: FloatArray  # (N,)
    flow: FloatArray  # (E,)
    last_flow: FloatArray  # (E,) before the last iteration
    divergence: FloatArray  # (N,) of the flow
    last_divergence: FloatArray  # (N,)
    momentum: float  # the sequence t_k of FISTA

    @classmethod
    def of(cls, graph: SurfaceGraph) -> "InnerProblem":
        """The problem before any supply is known, with no flow.

        The Hessian of half the dual in alpha = x / w is A^T diag(1 / vol) A, A[i, e] = +-w[e]. Two bounds of it are the
        number 2 max_i sum_j w[i, j]^2 / vol[i], as in the paper, and the diagonal matrix of its absolute row sums,
        w[e] (q[i] + q[j]) with q = degree / volume. The second one gives every edge its own step.
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
            start=start,
            other=second.astype(np.uint32),
            weight=weight,
            step=weight / (q[first] + q[second]),
            supply=nodes,
            flow=edges,
            last_flow=edges.copy(),
            divergence=nodes.copy(),
            last_divergence=nodes.copy(),
            momentum=1.0,
        )

    def aim(self, supply: FloatArray) -> None:
        """Take another supply: add to the flow the electrical one of what it lacks, cut off at the capacities.

        The sign of a supply does not matter to the method; the one that is nearer to the last supply is taken.
        """
        self.supply = supply if supply @ self.supply >= 0 else -supply
        potential = self.factor.solve(self.supply - self.divergence)
        _add_flow(self.start, self.other, self.weight, potential, self.flow, self.divergence)
        self.last_flow[:] = self.flow
        self.last_divergence[:] = self.divergence
        self.momentum = 1.0

    def advance(self, iterations: int) -> None:
        """Iterations of FISTA from where the last ones ended."""
        self.momentum = _fista(
            self.start,
            self.other,
            self.weight,
            self.step,
            self.graph.volume,
            self.supply,
            self.flow,
            self.last_flow,
            self.divergence,
            self.last_divergence,
            self.momentum,
            iterations,
        )

    @property
    def solution(self) -> FloatArray:
        """(N,): r, the solution of the inner problem up to scale."""
        return (self.supply - self.divergence) / self.graph.volume

    @property
    def gap(self) -> float:
        """No set A has a cut(A) that is less than supply(A) by more than this."""
        return float(np.maximum(self.supply - self.divergence, 0).sum())


@njit(cache=True)
def _add_flow(start, other, weight, potential, flow, divergence):  # type: ignore[no-untyped-def]
    for i in range(len(divergence)):
        divergence[i] = 0.0
    for i in range(len(divergence)):
        for e in range(start[i], start[i + 1]):
            j = other[e]
            added = flow[e] + weight[e] * (potential[i] - potential[j])
            flow[e] = min(max(added, -weight[e]), weight[e])
            divergence[i] += flow[e]
            divergence[j] -= flow[e]


@njit(cache=True)
def _fista(start, other, weight, step, volume, supply, flow, last_flow, divergence, last_divergence, t, iterations):  # type: ignore[no-untyped-def]
    """Accelerated projected gradient descent, restarted where the momentum leads uphill; returns the next t.

    The divergence of the extrapolated flow is extrapolated itself, so that an iteration runs over the edges once.
    """
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
                here = flow[e]
                moved = here + momentum * (here - last_flow[e]) + step[e] * (r[i] - r[j])
                last_flow[e] = here
                flow[e] = min(max(moved, -weight[e]), weight[e])
                leaving += flow[e]
                divergence[j] -= flow[e]
            divergence[i] += leaving
    return t
