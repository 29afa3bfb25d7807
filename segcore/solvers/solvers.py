"""The solvers by name: each finds a small normalized Cheeger cut of a connected graph."""

from collections.abc import Callable

import numpy as np

from segcore.graphs.cheeger import Cut, sweep
from segcore.graphs.surface_graph import SurfaceGraph
from segcore.parameters import SegmentationParameters
from segcore.solvers.fiedler import fiedler_vectors
from segcore.solvers.flow import flow_cut
from segcore.solvers.inverse_power import inverse_power_cut
from segcore.solvers.p_laplacian import p_laplacian_cut
from segcore.solvers.split_bregman import split_bregman_cut

Solver = Callable[[SurfaceGraph, SegmentationParameters, np.random.Generator], Cut]


def flow(graph: SurfaceGraph, _: SegmentationParameters, _rng: np.random.Generator) -> Cut:
    """Eigenvectors, total variation flow, and improvement by maximum flows."""
    return flow_cut(graph)


def fiedler(graph: SurfaceGraph, _: SegmentationParameters, _rng: np.random.Generator) -> Cut:
    """p = 2: the sweep of the second eigenvector."""
    return sweep(graph, fiedler_vectors(graph)[:, 0])


def inverse_power(graph: SurfaceGraph, parameters: SegmentationParameters, rng: np.random.Generator) -> Cut:
    """p = 1, the paper's choice: the inverse power method of Hein and Buehler."""
    return inverse_power_cut(graph, starts=parameters.starts, rng=rng, **_iterations(parameters))


def split_bregman(graph: SurfaceGraph, parameters: SegmentationParameters, rng: np.random.Generator) -> Cut:
    """p = 1, the paper's second solver: the total variation flow of Szlam and Bresson."""
    return split_bregman_cut(graph, starts=parameters.starts, rng=rng, **_iterations(parameters))


def p_laplacian(graph: SurfaceGraph, parameters: SegmentationParameters, rng: np.random.Generator) -> Cut:
    """1 < p < 2: the continuation in p of Buehler and Hein, from the second eigenvector."""
    return p_laplacian_cut(graph, p=parameters.p, starts=1, rng=rng, **_iterations(parameters))


def _iterations(parameters: SegmentationParameters) -> dict[str, int]:
    return {} if parameters.iterations is None else {"iterations": parameters.iterations}


SOLVERS: dict[str, Solver] = {
    "flow": flow,
    "fiedler": fiedler,
    "inverse_power": inverse_power,
    "split_bregman": split_bregman,
    "p_laplacian": p_laplacian,
}
