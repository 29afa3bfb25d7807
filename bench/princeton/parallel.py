"""Evaluates many models in several processes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

from bench.errors import BenchmarkError
from bench.pool import map_in_processes
from bench.princeton.dataset import Model
from bench.princeton.evaluation import ModelResult, SegmentChoice, Segmenter, evaluate_model


def evaluate_models(
    models: Sequence[Model],
    segmenter: Segmenter,
    seeds: tuple[int, ...],
    choice: SegmentChoice,
    jobs: int,
    learned: Mapping[int | str, Mapping[str, Any]] | None = None,
) -> list[ModelResult]:
    """Return the results of all models, in their order, computed in ``jobs`` processes of one thread each.

    Parameters
    ----------
    learned : for every model, by its number, the learned models to use; None for the ones that ship.

    Raises
    ------
    BenchmarkError
        If ``learned`` lacks a model, a model fails, or a process dies.
    """
    evaluate = partial(evaluate_model, segmenter=segmenter, seeds=seeds, choice=choice)
    if learned is not None:
        missing = [model.number for model in models if model.number not in learned]
        if missing:
            raise BenchmarkError(f"No fold leaves out model {missing[0]}: train the folds on the same models.")
        evaluate = partial(_evaluate_unseen, learned, evaluate)
    return map_in_processes(evaluate, models, jobs, segmenter.warm_up)


def _evaluate_unseen(
    learned: Mapping[int | str, Mapping[str, Any]], evaluate: Callable[[Model], ModelResult], model: Model
) -> ModelResult:
    from segcore.learned.models import LearnedModels, using

    with using(LearnedModels.from_document(learned[model.number])):
        return evaluate(model)
