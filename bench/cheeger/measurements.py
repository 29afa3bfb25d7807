"""Runs the solvers on graphs and measures their cuts and times."""

from __future__ import annotations

import statistics
import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.princeton.dataset import Model
from segcore.affinity.mesh_graphs import mesh_graph
from segcore.clean.surface import build_surface
from segcore.coarsen.clusters import cluster_nodes
from segcore.graphs.cheeger import Cut
from segcore.graphs.surface_graph import SurfaceGraph, connected_components
from segcore.parameters import SegmentationParameters
from segcore.solvers.solvers import SOLVERS


@dataclass(frozen=True, slots=True)
class Measurement:
    """The runs of a solver on a graph with different seeds."""

    ncc: float  # mean
    worst: float
    seconds: float  # median of the CPU times, on which other work on the machine has less influence


Row = dict[str, Measurement]  # by solver


def first_cut_graphs(model: Model) -> dict[str, SurfaceGraph]:
    """Return the largest components of the coarse and of the fine graph of a model, at the default parameters."""
    parameters = SegmentationParameters()
    fine = mesh_graph(build_surface(model.read_mesh()), parameters)
    rng = np.random.default_rng(parameters.seed)
    coarse = cluster_nodes(fine, parameters.clusters, rng)
    return {"coarse": _largest_component(coarse.graph), "fine": _largest_component(fine.graph)}


def measure(graph: SurfaceGraph, solvers: Sequence[str], runs: int) -> Row:
    """Run every solver on a graph with the seeds 0 to ``runs`` - 1."""
    return {solver: _measurement([_timed(graph, solver, seed) for seed in range(runs)]) for solver in solvers}


def warm_up(solvers: Sequence[str]) -> None:
    """Compile the kernels of the solvers by cutting a ladder of 40 nodes."""
    rung = np.arange(40, dtype=np.int32)
    edges = np.concatenate([np.stack([rung[:-1], rung[1:]], axis=1), np.stack([rung[:-2], rung[2:]], axis=1)])
    ones = np.ones(len(edges))
    measure(SurfaceGraph(edges, ones, np.ones(40), ones), solvers, 1)


def _largest_component(graph: SurfaceGraph) -> SurfaceGraph:
    component = connected_components(graph.edges, graph.node_count)
    return graph.subgraph(np.flatnonzero(component == np.bincount(component).argmax()).astype(np.int32))


def _timed(graph: SurfaceGraph, solver: str, seed: int) -> tuple[Cut, float]:
    rng = np.random.default_rng(seed)
    begin = time.process_time()
    cut = SOLVERS[solver](graph, SegmentationParameters(), rng)
    return cut, time.process_time() - begin


def _measurement(runs: list[tuple[Cut, float]]) -> Measurement:
    values = [cut.ncc for cut, _ in runs]
    return Measurement(statistics.mean(values), max(values), statistics.median(seconds for _, seconds in runs))
