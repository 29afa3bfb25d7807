"""Fits both models to all meshes of the benchmark, and again without each group of meshes."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Literal

import numpy as np

from bench.learning.boundaries import boundary_rows
from bench.learning.fitting import fit
from bench.learning.folds import Fold
from bench.learning.rows import concatenated
from bench.learning.splits import cut_rows
from bench.pool import map_in_processes
from segcore.affinity.boundary_features import FEATURES as EDGE_FEATURES
from segcore.cut.features import FEATURES as CUT_FEATURES
from segcore.learned.logistic import LogisticModel
from segcore.learned.models import LearnedModels, using
from segcore.warm_up import warm_up

if TYPE_CHECKING:
    from bench.learning.rows import Rows
    from bench.princeton.dataset import Model

Grouping = Literal["category", "fifth"]

# Set by hand; the quality with these values is in docs/explanation/learned-models.md.
_BOUNDARY_RIDGE = 1e-4
_SPLIT_RIDGE = 1e-2
_ROUNDS = 2  # of growing trees and fitting to them, because the fitted rule grows other trees


def train(models: Sequence[Model], grouping: Grouping, jobs: int) -> list[Fold]:
    """Learn from all models, and for every group of models from all others.

    The tree of a model is grown with a boundary model that was learned without its group. Otherwise the trees of the
    training would be better than those of new meshes.

    Returns
    -------
    First the fold "all", which leaves out nothing, then one for every group.
    """
    groups = _groups(models, grouping)
    edges = map_in_processes(boundary_rows, models, jobs, warm_up)
    flat = _flat(CUT_FEATURES)
    folds = [
        Fold(name, left_out, LearnedModels(_fit(EDGE_FEATURES, models, edges, left_out, _BOUNDARY_RIDGE), flat))
        for name, left_out in groups.items()
    ]
    for _ in range(_ROUNDS):
        grow = partial(_grow, {number: fold.models.document() for fold in folds for number in fold.left_out})
        cuts = map_in_processes(grow, models, jobs, warm_up)
        folds = [
            Fold(
                fold.name,
                fold.left_out,
                LearnedModels(fold.models.boundary, _fit(CUT_FEATURES, models, cuts, fold.left_out, _SPLIT_RIDGE)),
            )
            for fold in folds
        ]
    return folds


def _groups(models: Sequence[Model], grouping: Grouping) -> dict[str, frozenset[int]]:
    """Return the numbers of the models of every group, after an empty group "all"."""
    groups: dict[str, set[int]] = {"all": set()}
    for position, model in enumerate(models):
        name = model.category if grouping == "category" else f"fifth{position % 5 + 1}"
        groups.setdefault(name, set()).add(model.number)
    return {name: frozenset(numbers) for name, numbers in groups.items()}


def _grow(models_of: dict[int | str, dict[str, object]], model: Model) -> Rows:
    with using(LearnedModels.from_document(models_of[model.number])):
        return cut_rows(model)


def _fit(
    names: tuple[str, ...], models: Sequence[Model], rows: Sequence[Rows], left_out: frozenset[int | str], ridge: float
) -> LogisticModel:
    seen = [row for model, row in zip(models, rows, strict=True) if model.number not in left_out]
    return fit(names, concatenated(seen), ridge)


def _flat(names: tuple[str, ...]) -> LogisticModel:
    """Return a model with weights 0, with which the rule depends on the normalized cut alone."""
    count = len(names)
    return LogisticModel(names, np.zeros(count), np.ones(count), np.zeros(4 * count), 0.0)
