"""The inverse power method for the 1-Laplacian, p = 1: the solver that the paper prefers."""

from math import inf

import numpy as np

from segcore.graphs.cheeger import Cut, balance_subgradient, sweep
from segcore.graphs.surface_graph import SurfaceGraph
from segcore.solvers.inner_problem import InnerProblem
from segcore.solvers.starts import start_functions

FIRST_ITERATIONS = 50  # before the first sweep; the second one comes after as many again, and so on
WORTHWHILE_GAIN = 0.02  # relative: a start is given up once the duality gap leaves less to gain over the best cut
LEAST_GAIN = 1e-12  # relative: a smaller one is rounding


def inverse_power_cut(graph: SurfaceGraph, *, starts: int = 6, iterations: int = 800, rng: np.random.Generator) -> Cut:
    """The best normalized Cheeger cut that the inverse power method finds from several starts.

    It minimises F(f) = R(f) / B(f), R(f) = sum of w[i, j] |f[i] - f[j]|, B(f) = min over c of sum vol[i] |f[i] - c|,
    whose value at the indicator of a set is the normalized Cheeger cut. A step from f, with v a subgradient of B at f,
    solves the inner problem

        minimise R(g) - F(f) <g, v> over the unit ball, for which sum vol[i] g[i]^2 <= 1,

    and thresholds the solution g at its best value. F falls with every step; the method ends where it cannot fall.

    Parameters
    ----------
    graph : connected, at least two nodes.
    starts : at least 1. The first one is the Fiedler vector, so that the result is never worse than its sweep; the
        others are random smooth functions.
    iterations : the most of FISTA in one inner problem; the duality gap ends most of them earlier.

    Returns
    -------
    The cut, node 0 in S.

    Raises
    ------
    ValueError
        Where the graph is not connected.

    References
    ----------
    Hein and Buehler, An inverse power method for nonlinear eigenproblems with applications in 1-spectral clustering
    and sparse PCA, NIPS 2010.
    """
    problem = InnerProblem.of(graph)
    seen: set[bytes] = set()
    found: list[Cut] = []
    for values in start_functions(graph, problem.factor, starts, rng):
        best = min((cut.ncc for cut in found), default=inf)
        found.append(_descend(problem, sweep(graph, values), best, iterations, seen))
    return min(found, key=lambda cut: cut.ncc).canonical


def _descend(problem: InnerProblem, cut: Cut, best: float, iterations: int, seen: set[bytes]) -> Cut:
    """Steps of the method until one fails, cannot better the best cut by much, or has been made before."""
    while cut.key not in seen:
        seen.add(cut.key)
        problem.aim(cut.ncc * balance_subgradient(problem.graph, cut))
        cut = _step(problem, cut, min(best, cut.ncc), iterations)
    return cut


def _step(problem: InnerProblem, cut: Cut, best: float, iterations: int) -> Cut:
    """A better cut from the inner problem, however far it is solved; the same one where there is none."""
    done = 0
    while done < iterations:
        more = min(max(FIRST_ITERATIONS, done), iterations - done)
        problem.advance(more)
        done += more
        swept = sweep(problem.graph, problem.solution)
        if swept.ncc < cut.ncc * (1 - LEAST_GAIN):
            return swept
        if cut.ncc * (1 - problem.gap / cut.weight) >= best * (1 - WORTHWHILE_GAIN):
            break
    return cut
