"""The solvers by their names: each finds a small normalized Cheeger cut of a connected graph."""

from collections.abc import Callable

import numpy as np

from segcore.cheeger import Cut, sweep
from segcore.fiedler import fiedler_vectors
from segcore.flow import flow_cut
from segcore.graph import SurfaceGraph
from segcore.parameters import SegmentationParameters

Solver = Callable[[SurfaceGraph, SegmentationParameters, np.random.Generator], Cut]


def flow(graph: SurfaceGraph, _: SegmentationParameters, _rng: np.random.Generator) -> Cut:
    """Several eigenvectors, swept, and improved exactly by maximum flows."""
    return flow_cut(graph)


def fiedler(graph: SurfaceGraph, _: SegmentationParameters, _rng: np.random.Generator) -> Cut:
    """p = 2: the sweep of the second eigenvector."""
    return sweep(graph, fiedler_vectors(graph)[:, 0])


SOLVERS: dict[str, Solver] = {"flow": flow, "fiedler": fiedler}
