"""Initial functions on a graph for the solvers with p < 2."""

from collections.abc import Iterator

import numpy as np

from segcore.array_kernels import dot
from segcore.arrays import FloatArray
from segcore.graphs.laplacian import LaplacianFactor
from segcore.graphs.surface_graph import SurfaceGraph
from segcore.solvers.fiedler import eigenvectors

# Steps of the linear inverse power method on noise, which leave the low frequencies. Set by hand, and compared with its
# neighbours in bench/RESULTS.md, "Constants and their neighbours".
SMOOTHING_STEPS = 2


def start_functions(
    graph: SurfaceGraph, factor: LaplacianFactor, starts: int, rng: np.random.Generator
) -> Iterator[FloatArray]:
    """Yield the Fiedler vector, then random smooth functions, (N,) each.

    Parameters
    ----------
    graph : connected, at least two nodes.
    factor : of the graph's Laplacian.
    starts : how many, at least 1.

    Raises
    ------
    ValueError
        If the graph is not connected.
    """
    yield eigenvectors(graph, factor, 1)[:, 0]
    for _ in range(starts - 1):
        values = rng.standard_normal(graph.node_count)
        for _ in range(SMOOTHING_STEPS):
            mean = dot(graph.volume, values) / graph.total_volume
            values = factor.solve(graph.volume * (values - mean))
        yield values
