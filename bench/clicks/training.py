"""Learns the choices of ``segcore.edit``: which part a mark means, and which change a further mark means.

Both are conditional logits that maximise the expected IoU of the chosen candidate. Corrections are learned from the
parts that the choices so far lead to (Ross, Gordon and Bagnell, A reduction of imitation learning and structured
prediction to no-regret online learning, 2011): first those of the best candidates, then those of the learned ones.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import minimize

from bench.assets.dataset import Asset
from bench.clicks.evaluation import group_of, segmentations_of
from bench.clicks.person import Shape
from bench.errors import BenchmarkError
from bench.learning.fitting import LEAST_SCALE, rounded
from bench.learning.folds import Documents, apply_unseen, with_unseen
from bench.pool import map_in_processes
from bench.princeton.dataset import Model
from bench.segmenter import CleaveSegmenter
from segcore.edit.corrections import FEATURES, Mark, corrections
from segcore.edit.guide_graph import face_guide_graph, guide_clusters
from segcore.edit.tree_parts import FEATURES as PART_FEATURES
from segcore.edit.tree_parts import TreeParts
from segcore.learned.choices import ChoiceModel, ChoiceModels

if TYPE_CHECKING:
    from segcore.arrays import BoolArray, FloatArray

_ROUNDS = 3  # the first with the best candidates
_CORRECTIONS = 5  # clicks after the first
_RIDGE = 1e-3
_EXPLORED = 0.4  # share of the first round's choices that are made at random


@dataclass(frozen=True, slots=True, eq=False)
class Choice:
    """One choice between candidates."""

    key: int | str
    group: str
    is_asset: bool
    features: FloatArray  # (C, M)
    iou: FloatArray  # (C,) of the candidates


@dataclass(frozen=True, slots=True, eq=False)
class Choices:
    """The choices of some models."""

    part: list[Choice]
    correction: list[Choice]


@dataclass(frozen=True, slots=True, eq=False)
class Learned:
    """What was learned without the models of a group; of all models if there is none."""

    group: str | None
    left_out: frozenset[int | str]
    models: ChoiceModels


def train(
    models: Sequence[Model | Asset],
    segmenter: CleaveSegmenter,
    people: int | None,
    learned: Documents | None,
    jobs: int,
) -> list[Learned]:
    """Learn from all models, then without each group.

    Parameters
    ----------
    learned : for every model, the learned models that have not seen it, for its hierarchy.
    """
    part: list[Choice] = []
    correction: list[Choice] = []
    policy: ChoiceModels | None = None
    for _ in range(_ROUNDS):
        collect = partial(choices_of, segmenter=segmenter, people=people, policy=policy)
        found = map_in_processes(partial(apply_unseen, collect), with_unseen(models, learned), jobs, segmenter.warm_up)
        part = [choice for choices in found for choice in choices.part]
        correction += [choice for choices in found for choice in choices.correction]
        policy = _fitted(part, correction)
    assert policy is not None
    groups = sorted({(choice.is_asset, choice.group) for choice in part})
    keys = {group: frozenset(choice.key for choice in part if choice.group == group) for _, group in groups}
    return [Learned(None, frozenset(), policy)] + [
        Learned(
            group,
            keys[group],
            _fitted([c for c in part if c.group != group], [c for c in correction if c.group != group]),
        )
        for _, group in groups
    ]


def choices_of(
    model: Model | Asset, segmenter: CleaveSegmenter, people: int | None, policy: ChoiceModels | None
) -> Choices:
    """The choices that a simulated person of a model leads to.

    Parameters
    ----------
    policy : makes the choices; None: the best candidate is chosen, or one at random.
    """
    from segcore.clean.surface import build_surface

    mesh = model.read_mesh()
    hierarchy = segmenter(mesh, 0)
    surface = build_surface(mesh)
    shape = Shape.of(mesh, surface)
    faces = face_guide_graph(surface)
    clusters = guide_clusters(faces, hierarchy.face_leaf[shape.input_face], faces.count)
    parts = TreeParts.of(hierarchy, clusters.graph, clusters.leaf)
    rng = np.random.default_rng(0)
    found = Choices([], [])
    for labels in segmentations_of(model, len(mesh.faces), people):
        for wanted in shape.wanted_parts(labels):
            _follow(model, shape, parts, wanted, policy, rng, found)
    return found


def _follow(
    model: Model | Asset,
    shape: Shape,
    parts: TreeParts,
    wanted: BoolArray,
    policy: ChoiceModels | None,
    rng: np.random.Generator,
    found: Choices,
) -> None:
    """Add the choices for one part."""
    from segcore.learned.choices import using_choices

    def chosen(is_part: bool, sets: list[BoolArray], features: FloatArray) -> BoolArray:
        iou = np.array([shape.iou(candidate, wanted) for candidate in sets])
        choice = Choice(model.key, group_of(model), isinstance(model, Asset), features, iou)
        (found.part if is_part else found.correction).append(choice)
        if policy is not None:
            own = policy.part if is_part else policy.correction
            return sets[int(np.argmax(own.log_probability(features)))]
        if not is_part and rng.random() < _EXPLORED:
            return sets[int(rng.integers(len(sets)))]
        return sets[int(np.argmax(iou))]

    first = shape.middle(wanted)
    around = parts.around(first)
    inside = chosen(True, [parts.mask(part) for part in around], parts.features(around, first))
    marks = [Mark(first, True)]
    with using_choices(policy or _indifferent()):
        for _ in range(_CORRECTIONS):
            marked = shape.next_click(inside, wanted)
            if marked is None:
                return
            marks.append(Mark(marked, bool(wanted[marked])))
            candidates = corrections(parts, inside, marks)
            inside = chosen(False, candidates.sets, candidates.features)


def _indifferent() -> ChoiceModels:
    """Models that find all candidates equally probable."""

    def zero(names: tuple[str, ...]) -> ChoiceModel:
        return ChoiceModel(names, np.zeros(len(names)), np.ones(len(names)), np.zeros(len(names)))

    return ChoiceModels(zero(PART_FEATURES), zero(FEATURES))


def _fitted(part: list[Choice], correction: list[Choice]) -> ChoiceModels:
    return ChoiceModels(fit(PART_FEATURES, part), fit(FEATURES, correction))


def fit(names: tuple[str, ...], choices: Sequence[Choice]) -> ChoiceModel:
    """Maximise the mean expected IoU less ridge |w|^2; benchmark and assets count equally.

    Raises
    ------
    BenchmarkError
        If there are no choices.
    """
    if not choices:
        raise BenchmarkError("There is nothing to learn from: no part needs a second click. Give more models.")
    features = np.concatenate([choice.features for choice in choices])
    iou = np.concatenate([choice.iou for choice in choices])
    counts = np.array([len(choice.iou) for choice in choices])
    first = np.concatenate([[0], np.cumsum(counts)[:-1]])
    which = np.repeat(np.arange(len(choices)), counts)
    is_asset = np.array([choice.is_asset for choice in choices])
    sizes = np.bincount(is_asset, minlength=2)
    weight = 1.0 / sizes[is_asset.astype(np.int64)]
    weight /= weight.sum()
    mean = rounded(features.mean(axis=0))
    scale = rounded(np.maximum(features.std(axis=0), LEAST_SCALE))
    columns = (features - mean) / scale

    def cost(w: FloatArray) -> tuple[float, FloatArray]:
        score = columns @ w
        score -= np.maximum.reduceat(score, first)[which]
        chance = np.exp(score)
        chance /= np.add.reduceat(chance, first)[which]
        expected = np.add.reduceat(chance * iou, first)
        slope = (weight[which] * chance * (iou - expected[which])) @ columns
        return _RIDGE * float(w @ w) - float(weight @ expected), 2.0 * _RIDGE * w - slope

    solution = minimize(cost, np.zeros(len(names)), jac=True, method="L-BFGS-B")
    return ChoiceModel(names, mean, scale, rounded(solution.x))
