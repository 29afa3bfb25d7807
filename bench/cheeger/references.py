"""Graphs with the cuts and the times of other programs."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.errors import BenchmarkError
from segcore.graphs.surface_graph import SurfaceGraph, weighted_degrees


@dataclass(frozen=True, slots=True)
class Reference:
    """A graph, and the results of other programs on it."""

    name: str
    graph: SurfaceGraph
    best_known: float  # the least known NCC
    six_starts: float  # mean NCC of the inverse power method, the code of Hein and Buehler with six starts
    six_starts_s: float  # its time in seconds


def read_references(folder: Path) -> list[Reference]:
    """Read the graphs of a folder that contains reference.tsv and NAME.npz for every row of it.

    An archive contains ``edges`` (E, 2), each undirected edge once, ``weights`` (E,) and optionally ``volumes`` (N,);
    by default the volume of a node is its weighted degree.

    Raises
    ------
    BenchmarkError
        If a file is missing or malformed.
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
