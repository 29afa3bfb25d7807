"""Evaluates several methods on the same models against the same people."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

from bench.errors import BenchmarkError
from bench.paper.label_cache import LabelCache
from bench.peers.method import Method, Outcome
from bench.pool import map_in_processes, one_thread
from bench.princeton.dataset import Model
from bench.princeton.evaluation import ModelResult, Run, leave_one_out
from bench.princeton.metrics import evaluate, mean_scores
from bench.princeton.surface import Segmentation, Surface


@dataclass(frozen=True, slots=True)
class MethodResults:
    """The results of one method on all models."""

    method: Method
    models: tuple[ModelResult, ...]
    failures: dict[int, str]  # reason by the number of the model, which then counts as one segment

    @property
    def cpu_s(self) -> list[float]:
        """CPU seconds of every model on which the method did not fail."""
        return [run.cpu_s for model in self.models if model.model not in self.failures for run in model.runs]


@dataclass(frozen=True, slots=True)
class _Judged:
    """The result of one method on one model."""

    result: ModelResult
    failure: str  # empty if there was none


def evaluate_methods(
    models: Sequence[Model], methods: Sequence[Method], cache: LabelCache, jobs: int
) -> dict[str, MethodResults]:
    """Return the results of every method, by its key, all with the given number of segments.

    All processes have one thread, even if the environment sets another number, because their times are compared.

    Raises
    ------
    BenchmarkError
        If a file of a model cannot be used, a method cannot be called, or a process dies.
    """
    judge = partial(_judge_all, methods=tuple(methods), cache=cache)
    with one_thread():
        judged = map_in_processes(judge, models, jobs, partial(_warm_up, tuple(methods)))
    return {method.key: _collect(method, [row[i] for row in judged]) for i, method in enumerate(methods)}


def _warm_up(methods: tuple[Method, ...]) -> None:
    for method in methods:
        method.warm_up()


def _collect(method: Method, judged: Sequence[_Judged]) -> MethodResults:
    failures = {one.result.model: one.failure for one in judged if one.failure}
    return MethodResults(method, tuple(one.result for one in judged), failures)


def _judge_all(model: Model, methods: tuple[Method, ...], cache: LabelCache) -> list[_Judged]:
    """Return the result of every method on a model."""
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
    return [_Judged(result, outcome.failure) for result, outcome in zip(results, outcomes, strict=True)]


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
