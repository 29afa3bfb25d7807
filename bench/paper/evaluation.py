"""Several methods on the same models, all against the same people."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

from bench.errors import BenchmarkError
from bench.paper.label_cache import LabelCache
from bench.paper.processes import in_processes
from bench.peers.method import Method, Outcome
from bench.princeton.dataset import Model
from bench.princeton.evaluation import ModelResult, Run, leave_one_out
from bench.princeton.metrics import evaluate, mean_scores
from bench.princeton.surface import Segmentation, Surface


@dataclass(frozen=True, slots=True)
class MethodResults:
    """What one method made of all models."""

    method: Method
    models: tuple[ModelResult, ...]
    failures: dict[int, str]  # by the number of the model, which then counts as one segment

    @property
    def cpu_s(self) -> list[float]:
        """Of every model that the method did not fail on."""
        return [run.cpu_s for model in self.models if model.model not in self.failures for run in model.runs]


def evaluate_methods(
    models: Sequence[Model], methods: Sequence[Method], cache: LabelCache, jobs: int
) -> dict[str, MethodResults]:
    """The results of every method, by its key, all with the given number of segments.

    Raises
    ------
    BenchmarkError
        Where a file of a model cannot be used, a method cannot be called at all or a process dies.
    """
    judge = partial(_judge_all, methods=tuple(methods), cache=cache)
    judged = in_processes(judge, models, jobs, partial(_warm_up, tuple(methods)))
    return {method.key: _collect(method, [row[i] for row in judged]) for i, method in enumerate(methods)}


def _warm_up(methods: tuple[Method, ...]) -> None:
    for method in methods:
        method.warm_up()


def _collect(method: Method, judged: Sequence[tuple[ModelResult, str]]) -> MethodResults:
    failures = {result.model: failure for result, failure in judged if failure}
    return MethodResults(method, tuple(result for result, _ in judged), failures)


def _judge_all(model: Model, methods: tuple[Method, ...], cache: LabelCache) -> list[tuple[ModelResult, str]]:
    """For every method the result on a model, and why it failed there if it did."""
    mesh = model.read_mesh()
    labels_of_people = model.read_people(len(mesh.faces))
    try:
        surface = Surface.from_mesh(mesh.vertices, mesh.faces)
        people = [Segmentation.of(surface, labels) for labels in labels_of_people]
        people_scores = leave_one_out(surface, people)
        outcomes = [cache.outcome(method, model.number, mesh, model.segments) for method in methods]
        runs = [_run(surface, people, outcome, model.segments) for outcome in outcomes]
    except (BenchmarkError, ValueError) as error:
        raise BenchmarkError(f"Model {model.number}: {error}") from error
    results = [
        ModelResult(model.number, model.category, len(mesh.faces), len(people), model.segments, (run,), people_scores)
        for run in runs
    ]
    return [(result, outcome.failure) for result, outcome in zip(results, outcomes, strict=True)]


def _run(surface: Surface, people: list[Segmentation], outcome: Outcome, requested: int) -> Run:
    segmentation = Segmentation.of(surface, outcome.labels)
    scores = [evaluate(surface, segmentation, person) for person in people]
    return Run(
        seed=0,
        segments=segmentation.segments,
        fell_short=segmentation.segments < requested,
        cpu_s=outcome.cpu_s,
        undefined_cut_discrepancies=sum(math.isnan(score.cut_discrepancy) for score in scores),
        scores=mean_scores(scores),
    )
