"""The inverse power method for the 1-Laplacian, p = 1: the solver that the paper prefers."""

from math import inf

import numpy as np

from segcore.graphs.cheeger import Cut, balance_subgradient, sweep
from segcore.graphs.surface_graph import SurfaceGraph
from segcore.solvers.inner_problem import InnerProblem
from segcore.solvers.starts import start_functions

# Set by hand. The first two are compared with their neighbours in bench/RESULTS.md, "Constants and their neighbours".
FIRST_ITERATIONS = 50  # of FISTA before the first sweep; each further sweep comes when the total has doubled
WORTHWHILE_GAIN = 0.02  # a start ends if the duality gap allows a smaller relative gain over the best cut
LEAST_GAIN = 1e-12  # relative decrease of the value; a smaller one is rounding error


def inverse_power_cut(graph: SurfaceGraph, *, starts: int = 6, iterations: int = 800, rng: np.random.Generator) -> Cut:
    """Return the best normalized Cheeger cut that the inverse power method finds from several starts.

    The method minimises F(f) = R(f) / B(f), R(f) = sum of w[i, j] |f[i] - f[j]|, B(f) = min over c of the sum of
    vol[i] |f[i] - c|, whose value at the indicator of a set is the normalized Cheeger cut. A step from f, with v a
    subgradient of B at f, solves the inner problem

        minimise R(g) - F(f) <g, v> over the unit ball, for which sum vol[i] g[i]^2 <= 1,

    and thresholds the solution g at its best value. F falls in every step; the method ends when it cannot fall further.

    Parameters
    ----------
    graph : connected, at least two nodes.
    starts : at least 1. The first one is the Fiedler vector, so that the result is never worse than its sweep; the
        others are random smooth functions.
    iterations : limit of the FISTA iterations in one inner problem; the duality gap ends most of them earlier.

    Returns
    -------
    The cut, node 0 in S.

    Raises
    ------
    ValueError
        If the graph is not connected.

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
    """Make steps until one fails, cannot improve on the best cut by much, or repeats an earlier one."""
    while cut.key not in seen:
        seen.add(cut.key)
        problem.aim(cut.ncc * balance_subgradient(problem.graph, cut))
        cut = _step(problem, cut, min(best, cut.ncc), iterations)
    return cut


def _step(problem: InnerProblem, cut: Cut, best: float, iterations: int) -> Cut:
    """Return a better cut from the inner problem, solved only as far as needed, or the same cut if there is none."""
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
