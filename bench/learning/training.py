"""Fits both models to all meshes of the benchmark, and again without each group of meshes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
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
from segcore.cut.features import CutFeatures
from segcore.learned.logistic import LogisticModel
from segcore.learned.models import LearnedModels, using
from segcore.warm_up import warm_up

if TYPE_CHECKING:
    from bench.learning.examples import Example
    from bench.learning.rows import Rows

Grouping = Literal["category", "fifth"]

# Set by hand; the quality with these values is in docs/explanation/learned-models.md.
_BOUNDARY_RIDGE = 1e-4
_SPLIT_RIDGE = 1e-2
_BODIES_RIDGE = 3e-2  # of the model for surfaces of several bodies, of which there are fewer kinds
_ROUNDS = 2  # of growing trees and fitting to them, because the fitted rule grows other trees

# Of meshes of one body in the model for several bodies, beside the others: they are most of the meshes. Set by hand.
_ONE_BODY_WEIGHT = 0.1

# Features that tell the sets of assets apart rather than good cuts from bad ones: without them the model does better on
# sets that it has not seen.
_OF_SETS = ("bodies", "mean_affinity", "small_confidence", "large_confidence")
_ONE_BODY_FEATURES = CutFeatures._fields  # further ones make it worse on categories that it has not seen
_SEVERAL_BODIES_FEATURES = tuple(name for name in CUT_FEATURES if name not in _OF_SETS)


def train(meshes: Sequence[Example], grouping: Grouping, jobs: int) -> list[Fold]:
    """Learn from all meshes, and for every group of meshes from all others.

    The tree of a mesh is grown with a boundary model that was learned without its group. Otherwise the trees of the
    training would be better than those of new meshes.

    Returns
    -------
    First the fold "all", which leaves out nothing, then one for every group.
    """
    groups = _groups(meshes, grouping)
    edges = map_in_processes(boundary_rows, meshes, jobs, warm_up)
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
        grow = partial(_grow, {number: fold.models.document() for fold in folds for number in fold.left_out})
        cuts = map_in_processes(grow, meshes, jobs, warm_up)
        folds = [replace(fold, models=_with_splits(fold.models, _seen(meshes, cuts, fold.left_out))) for fold in folds]
    return folds


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
        fit(_SEVERAL_BODIES_FEATURES, _columns(rows, _SEVERAL_BODIES_FEATURES), _BODIES_RIDGE),
    )


def _columns(rows: Rows, names: Sequence[str]) -> Rows:
    return replace(rows, features=rows.features[:, [CUT_FEATURES.index(name) for name in names]])


def _groups(meshes: Sequence[Example], grouping: Grouping) -> dict[str, frozenset[int | str]]:
    """Return the keys of the meshes of every group, after an empty group "all"."""
    groups: dict[str, set[int | str]] = {"all": set()}
    for position, example in enumerate(meshes):
        name = example.group if grouping == "category" else f"fifth{position % 5 + 1}"
        groups.setdefault(name, set()).add(example.key)
    return {name: frozenset(numbers) for name, numbers in groups.items()}


def _grow(models_of: dict[int | str, dict[str, object]], example: Example) -> Rows:
    with using(LearnedModels.from_document(models_of[example.key])):
        return cut_rows(example)


def _seen(meshes: Sequence[Example], rows: Sequence[Rows], left_out: frozenset[int | str]) -> Rows:
    """Return the rows of all meshes that are not left out, with the weights of the meshes."""
    return concatenated(
        [
            replace(row, weight=example.weight * row.weight)
            for example, row in zip(meshes, rows, strict=True)
            if example.key not in left_out
        ]
    )


def _flat(names: tuple[str, ...]) -> LogisticModel:
    """Return a model with weights 0, with which the rule depends on the normalized cut alone."""
    count = len(names)
    return LogisticModel(names, np.zeros(count), np.ones(count), np.zeros(4 * count), 0.0)
