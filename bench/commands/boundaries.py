"""The length of Cleave's cuts compared with those of people, on the same models with the number of segments given.

Lengths are in sqrt(total area) of a model. The ratio is the geometric mean over the models of the length of Cleave's
cuts over the mean length of the people's. The cut discrepancy is the mean distance between the cuts, in mean radii of
the model.
"""

from __future__ import annotations

import argparse
import math
import statistics
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from bench.princeton.dataset import Model, read_models
from bench.princeton.evaluation import Segmenter
from bench.princeton.metrics import evaluate, mean_scores
from bench.princeton.surface import Segmentation, Surface
from bench.segmenter import CleaveSegmenter
from bench.text import format_table, number

if TYPE_CHECKING:
    from segcore.arrays import IntArray, LongArray
    from segcore.mesh import Mesh


@dataclass(frozen=True, slots=True)
class CutLengths:
    """The lengths of the cuts of one model, in sqrt(total area), and their distances."""

    category: str
    cleave: float
    people: float  # mean over the people
    cut_discrepancy: float  # mean over the people
    people_cut_discrepancy: float  # of the people against each other


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--data", type=Path, required=True, metavar="DIR", help="the folder of the benchmark")
    parser.add_argument("--limit", type=int, metavar="N", help="only N models, spread evenly over the list")
    parser.add_argument("--seed", type=int, default=0, metavar="S", help="seed of the segmentation (default 0)")


def run(arguments: argparse.Namespace) -> None:
    segmenter = CleaveSegmenter()
    models = read_models(arguments.data, arguments.limit)
    segmenter.warm_up()
    print(render([measure(model, segmenter, arguments.seed) for model in models]))


def length_of_cuts(mesh: Mesh, surface: Surface, labels: IntArray | LongArray) -> float:
    """Return the length of all edges between faces with different labels, over sqrt(total area)."""
    one, other = labels[surface.adjacent_faces].T
    ends = mesh.vertices[surface.shared_edge[one != other]]
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum()
    return float(length / math.sqrt(surface.face_area.sum()))


def measure(model: Model, segmenter: Segmenter, seed: int) -> CutLengths:
    """Segment a model and compare the cuts with those of its people."""
    mesh = model.read_mesh()
    people = model.read_people(len(mesh.faces))
    surface = Surface.from_mesh(mesh.vertices, mesh.faces)
    hierarchy = segmenter(mesh, seed)
    labels = hierarchy.labels(min(model.segments, hierarchy.max_segments))
    own = Segmentation.of(surface, labels)
    others = [Segmentation.of(surface, labels_of_one) for labels_of_one in people]
    pairs = [(one, other) for one in others for other in others if one is not other]
    return CutLengths(
        category=model.category,
        cleave=length_of_cuts(mesh, surface, labels),
        people=statistics.fmean(length_of_cuts(mesh, surface, labels_of_one) for labels_of_one in people),
        cut_discrepancy=mean_scores([evaluate(surface, own, other) for other in others]).cut_discrepancy,
        people_cut_discrepancy=mean_scores([evaluate(surface, *pair) for pair in pairs]).cut_discrepancy,
    )


def render(lengths: Sequence[CutLengths]) -> str:
    """Return a line for every category and one for all models."""
    categories = dict.fromkeys(one.category for one in lengths)
    rows = [_row(name, [one for one in lengths if one.category == name]) for name in categories]
    rows.append(_row("All models", lengths))
    header = ["category", "models", "length", "people's", "ratio", "cut discr.", "people's"]
    return format_table(header, rows, rules=(len(categories),))


def _row(name: str, lengths: Sequence[CutLengths]) -> list[str]:
    logarithms = [math.log(one.cleave / one.people) for one in lengths if one.cleave > 0 < one.people]
    values = [
        statistics.fmean(one.cleave for one in lengths),
        statistics.fmean(one.people for one in lengths),
        math.exp(statistics.fmean(logarithms)) if logarithms else math.nan,
        _mean([one.cut_discrepancy for one in lengths]),
        _mean([one.people_cut_discrepancy for one in lengths]),
    ]
    return [name, str(len(lengths)), *map(number, values)]


def _mean(values: Sequence[float]) -> float:
    defined = [value for value in values if not math.isnan(value)]
    return statistics.fmean(defined) if defined else math.nan
