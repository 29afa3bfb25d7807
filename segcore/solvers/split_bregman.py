"""Total variation flow by split Bregman iterations, p = 1: the second solver of the paper."""

from itertools import islice

import numpy as np

from segcore.arrays import FloatArray
from segcore.graphs.cheeger import Cut
from segcore.graphs.laplacian import factorise
from segcore.graphs.surface_graph import SurfaceGraph
from segcore.solvers.starts import start_functions
from segcore.solvers.total_variation import TotalVariationFlow

# Set by hand, and compared with their neighbours in bench/RESULTS.md, "Constants and their neighbours".
ITERATIONS_PER_STEP = 10  # of the flow
STEPS_WITHOUT_GAIN = 5  # after which a start ends


def split_bregman_cut(graph: SurfaceGraph, *, starts: int = 6, iterations: int = 1000, rng: np.random.Generator) -> Cut:
    """Return the best normalized Cheeger cut on the way of total variation flow from several starts.

    Every step of the flow is thresholded at its best value. The values need not fall in every step; a start ends after
    some steps without a better cut, or at the limit of the iterations.

    Parameters
    ----------
    graph : connected, at least two nodes.
    starts : at least 1. The first one is the Fiedler vector, so that the result is never worse than its sweep; the
        others are random smooth functions.
    iterations : limit of the split Bregman iterations from one start.

    Returns
    -------
    The cut, node 0 in S.

    Raises
    ------
    ValueError
        If the graph is not connected.

    References
    ----------
    Szlam and Bresson, Total variation and Cheeger cuts, ICML 2010.
    """
    functions = list(start_functions(graph, factorise(graph), starts, rng))
    flow = TotalVariationFlow.of(graph, functions[0])
    steps = -(-iterations // ITERATIONS_PER_STEP)
    return min((_best_passed(flow, values, steps) for values in functions), key=lambda cut: cut.ncc).canonical


def _best_passed(flow: TotalVariationFlow, values: FloatArray, steps: int) -> Cut:
    cuts = flow.cuts(values, ITERATIONS_PER_STEP)
    best = next(cuts)
    since = 0
    for cut in islice(cuts, steps):
        since = 0 if cut.ncc < best.ncc else since + 1
        best = min(best, cut, key=lambda cut: cut.ncc)
        if since == STEPS_WITHOUT_GAIN:
            break
    return best
