"""Fits the models to all meshes of the benchmark, and again without each group of meshes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Literal

import numpy as np

from bench.learning.boundaries import boundary_rows
from bench.learning.fitting import fit
from bench.learning.folds import Fold, apply_unseen, with_unseen
from bench.learning.gaussian_process import fit_gaussian_process
from bench.learning.rows import concatenated
from bench.learning.splits import cut_rows, split_rows
from bench.pool import OF_SEGMENTATIONS, map_in_processes
from segcore import warm_up
from segcore.affinity.boundary_features import FEATURES as EDGE_FEATURES
from segcore.cut.features import FEATURES as CUT_FEATURES
from segcore.cut.features import CutFeatures
from segcore.cut.rules import SEVERAL_BODIES_FEATURES
from segcore.learned.logistic import LogisticModel
from segcore.learned.models import LearnedModels

if TYPE_CHECKING:
    from bench.learning.examples import Example
    from bench.learning.rows import Rows

Grouping = Literal["category", "fifth"]

# Set by hand; the quality with these values is in docs/explanation/learned-models.md.
_BOUNDARY_RIDGE = 1e-4
_SPLIT_RIDGE = 1e-2
_BODIES_RIDGE = 3e-2  # of the model for surfaces of several bodies, of which there are fewer kinds
_ROUNDS = 2  # of growing trees and fitting to them, because the fitted rule grows other trees

# On the weights of assets in the model of the order: a set counts as much as 10 models of the benchmark. That does not
# make it worse on the benchmark, as it does the logistic models. Set by hand.
_ASSETS_IN_ORDER = 4.0

# Of meshes of one body in the model for several bodies, beside the others: they are most of the meshes. Set by hand.
_ONE_BODY_WEIGHT = 0.1

_WARM_UP = partial(warm_up, *OF_SEGMENTATIONS)
_ONE_BODY_FEATURES = CutFeatures._fields  # further ones make it worse on categories that it has not seen


def train(meshes: Sequence[Example], grouping: Grouping, jobs: int) -> list[Fold]:
    """Learn from all meshes, and for every group of meshes from all others.

    The tree of a mesh is grown with a boundary model that was learned without its group. Otherwise the trees of the
    training would be better than those of new meshes. The model of the order is fitted last, to the trees that the
    other models give on meshes without whose group they were learned.

    Returns
    -------
    First the fold "all", which leaves out nothing, then one for every group.
    """
    groups = _groups(meshes, grouping)
    edges = map_in_processes(boundary_rows, meshes, jobs, _WARM_UP)
    flat = _flat(CUT_FEATURES)
    folds = [
        Fold(
            name,
            left_out,
            LearnedModels(fit(EDGE_FEATURES, _seen(meshes, edges, left_out), _BOUNDARY_RIDGE), flat, flat),
        )
        for name, left_out in groups.items()
    ]
    for _ in range(_ROUNDS):
        cuts = map_in_processes(partial(apply_unseen, cut_rows), with_unseen(meshes, _documents(folds)), jobs, _WARM_UP)
        folds = [replace(fold, models=_with_splits(fold.models, _seen(meshes, cuts, fold.left_out))) for fold in folds]
    splits = map_in_processes(partial(apply_unseen, split_rows), with_unseen(meshes, _documents(folds)), jobs, _WARM_UP)
    seen = [_seen(meshes, splits, fold.left_out, _ASSETS_IN_ORDER) for fold in folds]
    orders = map_in_processes(fit_gaussian_process, seen, jobs, _WARM_UP)
    return [replace(fold, models=replace(fold.models, order=order)) for fold, order in zip(folds, orders, strict=True)]


def _documents(folds: Sequence[Fold]) -> dict[int | str, dict[str, object]]:
    """The models that have not seen each mesh."""
    return {key: fold.models.document() for fold in folds for key in fold.left_out}


def _with_splits(models: LearnedModels, rows: Rows) -> LearnedModels:
    """Return the models with those of splits fitted to rows with all features.

    The model for one body is fitted to meshes of one body, the one for several bodies to all meshes.
    """
    one_body = rows.features[:, CUT_FEATURES.index("bodies")] == 0.0
    of_one_body = rows.part(one_body) if one_body.any() else rows
    rows = replace(rows, weight=np.where(one_body, _ONE_BODY_WEIGHT, 1.0) * rows.weight)
    return LearnedModels(
        models.boundary,
        fit(_ONE_BODY_FEATURES, _columns(of_one_body, _ONE_BODY_FEATURES), _SPLIT_RIDGE),
        fit(SEVERAL_BODIES_FEATURES, _columns(rows, SEVERAL_BODIES_FEATURES), _BODIES_RIDGE),
    )


def _columns(rows: Rows, names: Sequence[str]) -> Rows:
    return rows.columns([CUT_FEATURES.index(name) for name in names])


def _groups(meshes: Sequence[Example], grouping: Grouping) -> dict[str, frozenset[int | str]]:
    """Return the keys of the meshes of every group, after an empty group "all"."""
    groups: dict[str, set[int | str]] = {"all": set()}
    for position, example in enumerate(meshes):
        name = example.group if grouping == "category" else f"fifth{position % 5 + 1}"
        groups.setdefault(name, set()).add(example.key)
    return {name: frozenset(numbers) for name, numbers in groups.items()}


def _seen(meshes: Sequence[Example], rows: Sequence[Rows], left_out: frozenset[int | str], assets: float = 1.0) -> Rows:
    """Return the rows of all meshes that are not left out, weighted; ``assets`` is a factor on those of assets."""
    return concatenated(
        [
            replace(row, weight=example.weight * (assets if example.is_asset else 1.0) * row.weight)
            for example, row in zip(meshes, rows, strict=True)
            if example.key not in left_out
        ]
    )


def _flat(names: tuple[str, ...]) -> LogisticModel:
    """Return a model with weights 0, with which the rule depends on the normalized cut alone."""
    count = len(names)
    return LogisticModel(names, np.zeros(count), np.ones(count), np.zeros(4 * count), 0.0)
