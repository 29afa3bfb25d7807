"""Measurements of the solvers on graphs: the cut that each finds and the time that it takes."""

from __future__ import annotations

import csv
import statistics
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.errors import BenchmarkError
from bench.princeton.dataset import Model
from bench.text import format_table
from segcore.affinity.mesh_graphs import mesh_graph
from segcore.clean.surface import build_surface
from segcore.coarsen.clusters import cluster_nodes
from segcore.graphs.cheeger import Cut
from segcore.graphs.surface_graph import SurfaceGraph, connected_components, weighted_degrees
from segcore.parameters import SegmentationParameters
from segcore.solvers.solvers import SOLVERS

WITHIN = 1.005  # of the best value: a cut that counts as found


@dataclass(frozen=True, slots=True)
class Reference:
    """A graph, and what other code reaches on it."""

    name: str
    graph: SurfaceGraph
    best_known: float  # the least NCC seen by any means
    six_starts: float  # mean NCC of the inverse power method of Hein and Buehler, their code, six starts
    six_starts_s: float  # its time in seconds


@dataclass(frozen=True, slots=True)
class Measurement:
    """Runs of a solver on a graph, with different seeds."""

    ncc: float  # mean
    worst: float
    seconds: float  # median, of the processor: other work on the machine matters less than it does to the clock


Row = dict[str, Measurement]  # by solver


def read_references(folder: Path) -> list[Reference]:
    """The graphs of a folder with reference.tsv and, for every row of it, NAME.npz.

    An archive has ``edges`` (E, 2), each undirected edge once, ``weights`` (E,) and perhaps ``volumes`` (N,); without
    them, the volume of a node is its weighted degree.

    Raises
    ------
    BenchmarkError
        Where a file is missing or not as described.
    """
    try:
        with (folder / "reference.tsv").open(newline="", encoding="utf-8") as lines:
            return [_reference(folder, row) for row in csv.DictReader(lines, delimiter="\t")]
    except (OSError, KeyError, TypeError, ValueError) as error:
        raise BenchmarkError(f"{folder} is not a folder of reference graphs: {error}.") from error


def _reference(folder: Path, row: dict[str, str]) -> Reference:
    with np.load(folder / f"{row['graph']}.npz") as arrays:
        edges = np.sort(arrays["edges"], axis=1).astype(np.int32)
        weight = arrays["weights"].astype(np.float64)
        degrees = weighted_degrees(edges, weight, int(edges.max()) + 1)
        volume = arrays["volumes"].astype(np.float64) if "volumes" in arrays else degrees
    return Reference(
        name=row["graph"],
        graph=SurfaceGraph(edges, weight, volume, length=weight),
        best_known=float(row["ncc_best_known"]),
        six_starts=float(row["runs5_mean20"]),
        six_starts_s=float(row["seconds_runs5"]),
    )


def first_cut_graphs(model: Model) -> dict[str, SurfaceGraph]:
    """The largest components of the coarse and of the fine graph of a model, at the default parameters."""
    parameters = SegmentationParameters()
    fine = mesh_graph(build_surface(model.read_mesh()), parameters)
    rng = np.random.default_rng(parameters.seed)
    coarse = cluster_nodes(fine, parameters.clusters, rng)
    return {"coarse": _largest_component(coarse.graph), "fine": _largest_component(fine.graph)}


def _largest_component(graph: SurfaceGraph) -> SurfaceGraph:
    component = connected_components(graph.edges, graph.node_count)
    return graph.subgraph(np.flatnonzero(component == np.bincount(component).argmax()).astype(np.int32))


def measure(graph: SurfaceGraph, solvers: Sequence[str], runs: int) -> Row:
    return {solver: _measurement([_timed(graph, solver, seed) for seed in range(runs)]) for solver in solvers}


def warm_up(solvers: Sequence[str]) -> None:
    """Compile what the solvers need, on a ladder."""
    rung = np.arange(40, dtype=np.int32)
    edges = np.concatenate([np.stack([rung[:-1], rung[1:]], axis=1), np.stack([rung[:-2], rung[2:]], axis=1)])
    ones = np.ones(len(edges))
    measure(SurfaceGraph(edges, ones, np.ones(40), ones), solvers, 1)


def _timed(graph: SurfaceGraph, solver: str, seed: int) -> tuple[Cut, float]:
    rng = np.random.default_rng(seed)
    begin = time.process_time()
    cut = SOLVERS[solver](graph, SegmentationParameters(), rng)
    return cut, time.process_time() - begin


def _measurement(runs: list[tuple[Cut, float]]) -> Measurement:
    values = [cut.ncc for cut, _ in runs]
    return Measurement(statistics.mean(values), max(values), statistics.median(seconds for _, seconds in runs))


def render_references(references: Sequence[Reference], measured: Sequence[Row]) -> str:
    """A line for every graph, the means, and how many graphs reach what is demanded of a solver."""
    best = [
        min(reference.best_known, *(result.ncc for result in row.values()))
        for reference, row in zip(references, measured, strict=True)
    ]
    solvers = list(measured[0])
    header = ["graph", "nodes", *(f"{solver}: cut" for solver in solvers), *(f"{solver}: ms" for solver in solvers)]
    rows = [
        [reference.name, str(reference.graph.node_count), *_ratios(row, value), *_milliseconds(row)]
        for reference, row, value in zip(references, measured, best, strict=True)
    ]
    lines = [format_table(header, [*rows, *_summary(solvers, measured, best)], rules=[len(rows)]), ""]
    for solver, known, factor, share in (
        ("flow", [reference.best_known for reference in references], WITHIN, 20),
        ("inverse_power", [reference.six_starts for reference in references], 1.01, 10),
    ):
        if solver in solvers:
            lines.append(_demand(solver, references, [row[solver] for row in measured], known, factor, share))
    return "\n".join(lines)


def render_first_cuts(models: Sequence[Model], solvers: Sequence[str]) -> str:
    """The means over the first cuts of the models, and the cuts at which a solver is worse than it should be."""
    rows: dict[str, list[Row]] = {"coarse": [], "fine": []}
    notes = []
    for model in models:
        for kind, graph in first_cut_graphs(model).items():
            row = measure(graph, solvers, 1)
            rows[kind].append(row)
            notes += [f"model {model.number}, {kind}: {note}" for note in _failings(row)]
    tables = []
    for kind, measured in rows.items():
        best = [min(result.ncc for result in row.values()) for row in measured]
        header = [
            f"first cuts, {kind}",
            *(f"{solver}: cut" for solver in solvers),
            *(f"{solver}: ms" for solver in solvers),
        ]
        tables.append(format_table(header, [[row[0], *row[2:]] for row in _summary(solvers, measured, best)]))
    return "\n\n".join([*tables, "\n".join(notes) or "No solver for p < 2 is worse than p = 2 on any first cut."])


def _failings(row: Row) -> list[str]:
    """The solvers for p < 2 whose cut is worse than that of p = 2, which is where they start."""
    if "fiedler" not in row:
        return []
    limit = row["fiedler"].ncc * (1 + 1e-9)
    return [f"{solver} is worse than fiedler" for solver, result in row.items() if result.worst > limit]


def _summary(solvers: Sequence[str], measured: Sequence[Row], best: Sequence[float]) -> list[list[str]]:
    """Mean ratio and mean time, and the share of graphs where a solver finds the best value."""
    ratios = {
        solver: [row[solver].ncc / value for row, value in zip(measured, best, strict=True)] for solver in solvers
    }
    mean = [f"{statistics.mean(ratios[solver]):.4f}" for solver in solvers]
    mean_ms = [f"{1e3 * statistics.mean(row[solver].seconds for row in measured):.1f}" for solver in solvers]
    found = [f"{sum(ratio <= WITHIN for ratio in ratios[solver])} of {len(measured)}" for solver in solvers]
    return [["mean", "", *mean, *mean_ms], [f"at most {WITHIN}", "", *found]]


def _ratios(row: Row, best: float) -> list[str]:
    return [f"{result.ncc / best:.4f}" for result in row.values()]


def _milliseconds(row: Row) -> list[str]:
    return [f"{1e3 * result.seconds:.1f}" for result in row.values()]


def _demand(
    solver: str,
    references: Sequence[Reference],
    results: Sequence[Measurement],
    known: Sequence[float],
    factor: float,
    share: int,
) -> str:
    good = [result.ncc <= factor * value for result, value in zip(results, known, strict=True)]
    quick = [
        result.seconds <= reference.six_starts_s / share for result, reference in zip(results, references, strict=True)
    ]
    both = sum(a and b for a, b in zip(good, quick, strict=True))
    column = "ncc_best_known" if solver == "flow" else "runs5_mean20"
    return (
        f"{solver}: at most {factor} x {column} on {sum(good)}, in at most 1/{share} of seconds_runs5 on {sum(quick)}, "
        f"both on {both} of {len(results)} graphs"
    )
