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
_ROUNDS = 2  # of growing trees and fitting to them, because the fitted rule grows other trees


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
        Fold(name, left_out, LearnedModels(_fit(EDGE_FEATURES, meshes, edges, left_out, _BOUNDARY_RIDGE), flat))
        for name, left_out in groups.items()
    ]
    for _ in range(_ROUNDS):
        grow = partial(_grow, {number: fold.models.document() for fold in folds for number in fold.left_out})
        cuts = map_in_processes(grow, meshes, jobs, warm_up)
        folds = [
            Fold(
                fold.name,
                fold.left_out,
                LearnedModels(fold.models.boundary, _fit(CUT_FEATURES, meshes, cuts, fold.left_out, _SPLIT_RIDGE)),
            )
            for fold in folds
        ]
    return folds


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


def _fit(
    names: tuple[str, ...],
    meshes: Sequence[Example],
    rows: Sequence[Rows],
    left_out: frozenset[int | str],
    ridge: float,
) -> LogisticModel:
    seen = [
        replace(row, weight=example.weight * row.weight)
        for example, row in zip(meshes, rows, strict=True)
        if example.key not in left_out
    ]
    return fit(names, concatenated(seen), ridge)


def _flat(names: tuple[str, ...]) -> LogisticModel:
    """Return a model with weights 0, with which the rule depends on the normalized cut alone."""
    count = len(names)
    return LogisticModel(names, np.zeros(count), np.ones(count), np.zeros(4 * count), 0.0)
