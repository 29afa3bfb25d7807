"""Evaluates many models in several processes."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from bench.learning.folds import Documents, apply_unseen, with_unseen
from bench.pool import map_in_processes
from bench.princeton.dataset import Model
from bench.princeton.evaluation import ModelResult, SegmentChoice, Segmenter, evaluate_model


def evaluate_models(
    models: Sequence[Model],
    segmenter: Segmenter,
    seeds: tuple[int, ...],
    choice: SegmentChoice,
    jobs: int,
    learned: Documents | None = None,
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
    return map_in_processes(partial(apply_unseen, evaluate), with_unseen(models, learned), jobs, segmenter.warm_up)
