"""The tables and figures of the paper's evaluation: the methods that each of them needs, and its function."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from bench.errors import BenchmarkError
from bench.paper import methods
from bench.paper.charts import Bar, metric_chart, save_chart
from bench.paper.evaluation import MethodResults
from bench.paper.label_cache import LabelCache
from bench.paper.pictures import save_picture, side_by_side
from bench.paper.tables import difference_table, metric_table, rank_table, time_table
from bench.peers.method import Method
from bench.princeton.dataset import Model, read_models
from bench.princeton.metrics import evaluate, mean_scores
from bench.princeton.summary import overall
from bench.princeton.surface import Segmentation, Surface
from bench.text import format_table, number

if TYPE_CHECKING:
    from segcore.arrays import IntArray

# A model with the same features as that of Figure 5: a bearing with five segments given, one of them a narrow groove
# between two concave rings. The paper names no model.
BEARING = 341
BEARING_SEGMENTS = (4, 5)
GAINS = 3  # number of models in Figure 9


@dataclass(frozen=True, slots=True)
class Evaluation:
    """The results from which the items are made."""

    data: Path  # the folder of the benchmark
    models: Sequence[Model]  # the evaluated ones
    results: dict[str, MethodResults]  # by the key of the method
    peers: Sequence[Method]
    cache: LabelCache
    output: Path | None  # the folder for charts and pictures; None for text only

    def of(self, wanted: Sequence[Method]) -> list[MethodResults]:
        return [self.results[method.key] for method in wanted]


@dataclass(frozen=True, slots=True)
class Item:
    """One table or figure."""

    title: str
    methods: Callable[[Sequence[Method]], list[Method]]  # the methods it needs, given the peers
    make: Callable[[Evaluation], str]  # writes its files to the output folder and returns its text


def _figure4_methods(peers: Sequence[Method]) -> list[Method]:
    return [methods.inverse_power(), methods.split_bregman(), methods.two_spectral(), methods.cleave(), *peers]


def _figure4(evaluation: Evaluation) -> str:
    results = evaluation.of(_figure4_methods(evaluation.peers))
    _chart(evaluation, "figure4", results)
    first, *others = results
    return f"{metric_table(results)}\n\n{difference_table([(first, other) for other in others])}"


def _figure8_methods(_: Sequence[Method]) -> list[Method]:
    return [
        methods.two_spectral_on_adjacency(),
        methods.two_spectral(),
        methods.inverse_power_on_adjacency(),
        methods.inverse_power(),
    ]


def _figure8(evaluation: Evaluation) -> str:
    results = evaluation.of(_figure8_methods(()))
    _chart(evaluation, "figure8", results)
    two_adjacency, two_minima, one_adjacency, one_minima = results
    pairs = [
        (two_adjacency, two_minima),
        (one_adjacency, one_minima),
        (two_adjacency, one_adjacency),
        (two_minima, one_minima),
    ]
    return f"{metric_table(results)}\n\n{difference_table(pairs)}"


def _table1_methods(peers: Sequence[Method]) -> list[Method]:
    return [methods.cleave(), methods.inverse_power(), *peers]


def _table1(evaluation: Evaluation) -> str:
    return rank_table(evaluation.of(_table1_methods(evaluation.peers)))


def _table2(evaluation: Evaluation) -> str:
    return time_table(evaluation.of(_figure4_methods(evaluation.peers)))


def bearing(data: Path) -> Model:
    """Return the model of Figure 5; raises BenchmarkError if the data does not contain it."""
    model = next((model for model in read_models(data) if model.number == BEARING), None)
    if model is None:
        raise BenchmarkError(f"Figure 5 shows model {BEARING}, which the data does not have: leave it out by --only.")
    return model


def _figure5(evaluation: Evaluation) -> str:
    model = bearing(evaluation.data)
    mesh = model.read_mesh()
    surface = Surface.from_mesh(mesh.vertices, mesh.faces)
    people = [Segmentation.of(surface, labels) for labels in model.read_people(len(mesh.faces))]
    rows, pictures = [], []
    for method in (methods.inverse_power(), methods.inverse_power_unthinned()):
        hierarchy = method.hierarchy(mesh, max(BEARING_SEGMENTS))
        labels = [hierarchy.labels(min(count, hierarchy.max_segments)) for count in BEARING_SEGMENTS]
        rows += [[method.title, *_bearing_cells(surface, one, people)] for one in labels]
        pictures.append(side_by_side(mesh, labels))
    if evaluation.output is not None:
        save_picture(evaluation.output / "figure5.png", pictures)
    header = ["method", "segments", "1-Rand", "% of the area in each"]
    note = (
        f"Model {model.number} ({model.category}, {model.segments} segments given). A row of pictures for each method."
    )
    return "\n".join([note, "", format_table(header, rows)])


def _bearing_cells(surface: Surface, labels: IntArray, people: Sequence[Segmentation]) -> list[str]:
    segmentation = Segmentation.of(surface, labels)
    score = mean_scores([evaluate(surface, segmentation, person) for person in people]).one_minus_rand
    share = np.bincount(segmentation.label, surface.face_area) / surface.face_area.sum()
    return [str(segmentation.segments), number(score), " ".join(f"{100 * value:.1f}" for value in share)]


def _figure9_methods(_: Sequence[Method]) -> list[Method]:
    return [methods.two_spectral(), methods.inverse_power()]


def _figure9(evaluation: Evaluation) -> str:
    two, one = evaluation.of(_figure9_methods(()))
    gains = [
        (a.scores.one_minus_rand - b.scores.one_minus_rand, i)
        for i, (a, b) in enumerate(zip(two.models, one.models, strict=True))
    ]
    chosen = [i for gain, i in sorted(gains, reverse=True)[:GAINS] if gain > 0]
    rows = []
    for i in chosen:
        before, after = two.models[i].scores.one_minus_rand, one.models[i].scores.one_minus_rand
        model = evaluation.models[i]
        values = [before, after, before - after, one.models[i].people_scores.one_minus_rand]
        rows.append([f"{model.number} {model.category}", str(model.segments), *map(number, values)])
    if evaluation.output is not None and chosen:
        pictures = [_compared(evaluation, evaluation.models[i], [two.method, one.method]) for i in chosen]
        save_picture(evaluation.output / "figure9.png", pictures)
    header = ["model", "segments", "p = 2", "p = 1", "gain", "people"]
    note = "The models that gain most in 1-Rand by p = 1 (inverse power), minima rule. Left p = 2, right p = 1."
    return "\n".join([note, "", format_table(header, rows), "", difference_table([(two, one)])])


def _compared(evaluation: Evaluation, model: Model, compared: Sequence[Method]) -> np.ndarray:
    mesh = model.read_mesh()
    outcomes = [evaluation.cache.outcome(method, model.number, mesh, model.segments) for method in compared]
    return side_by_side(mesh, [outcome.labels for outcome in outcomes])


def _chart(evaluation: Evaluation, name: str, results: Sequence[MethodResults]) -> None:
    if evaluation.output is None:
        return
    bars = [Bar(one.method.title, overall(one.models).scores, _group(one.method, evaluation.peers)) for one in results]
    title = f"{len(evaluation.models)} models of the Princeton Segmentation Benchmark, number of segments given"
    people = overall(results[0].models).people_scores
    save_chart(evaluation.output / f"{name}.png", metric_chart(title, bars, people))


def _group(method: Method, peers: Sequence[Method]) -> int:
    """Return 0 for the methods of the paper, 1 for Cleave, 2 for the peers."""
    return 2 if method in peers else int(method.key == methods.cleave().key)


ITEMS = {
    "figure4": Item("Figure 4: the four metrics", _figure4_methods, _figure4),
    "figure8": Item("Figure 8: p and the matrix, each by itself", _figure8_methods, _figure8),
    "table1": Item("Table 1: ranks by category", _table1_methods, _table1),
    "table2": Item("Table 2: time", _figure4_methods, _table2),
    "figure5": Item("Figure 5: a bearing in four and in five segments", lambda _: [], _figure5),
    "figure9": Item("Figure 9: models on which p = 2 fails and p = 1 does not", _figure9_methods, _figure9),
}
