"""Rows for the models of splits and of the order: for cuts, the share of separated pairs that people join."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from bench.assets.dataset import NO_PART
from bench.datasets import on_surface
from bench.learning.rows import Rows
from segcore.arrays import group_sums
from segcore.clean.surface import build_surface
from segcore.cut.bisection import bisect
from segcore.cut.features import FEATURES
from segcore.cut.fields import ClusterFields, Segment, cluster_fields
from segcore.cut.rules import ORDER_FEATURES, LearnedRule, Split, order_features, paired
from segcore.method import CoarseGraph, coarse_graph, cut_by_rule
from segcore.parameters import USUAL_SEGMENTS, SegmentationParameters

if TYPE_CHECKING:
    from bench.learning.examples import Example
    from segcore.arrays import FloatArray, IntArray, LongArray
    from segcore.coarsen.clusters import Clusters
    from segcore.graphs.cheeger import Cut
    from segcore.graphs.tree import Tree


# Exponent of the share of all pairs that a cut separates, in the weight of its row. Set by hand, between equal weights
# (0) and weights by pairs (1), which the first cuts of each tree would dominate.
_SIZE_EXPONENT = 0.75
# Of the candidate that is taken, beside the others: the least of several estimates is too low on average. Set by hand.
_CHOSEN_WEIGHT = 4.0


def cut_rows(example: Example, seed: int = 0) -> Rows:
    """Grow the tree of a mesh with the learned models in use, and compare every candidate cut with the people.

    Pairs of points count by area. Cuts that separate no pair of points with a label are left out. The symmetry of the
    mesh is not used.
    """
    parameters = SegmentationParameters(seed=seed, max_segments=USUAL_SEGMENTS)
    coarse, people, rng = _coarse(example, parameters, is_symmetric=False)
    clusters = coarse.clusters
    rule = _Recorder(cluster_fields(coarse.refinement.surface, clusters, coarse.links), parameters, rng, people)
    bisect(clusters.graph, clusters.points, rule, USUAL_SEGMENTS)
    return _rows(rule.rows, rule.target, rule.weight, FEATURES)


def split_rows(example: Example, seed: int = 0) -> Rows:
    """Cut a mesh with the learned models in use, as ``segcore.segment`` does, and compare the splits with the people.

    Splits that separate no pair of points with a label are left out, and so are late ones.
    """
    parameters = SegmentationParameters(seed=seed)
    coarse, people, rng = _coarse(example, parameters, parameters.is_symmetric)
    clusters = coarse.symmetrised().clusters
    rule = _Finisher(cluster_fields(coarse.refinement.surface, clusters, coarse.links), parameters, rng)
    cut_by_rule(clusters, rule, parameters)
    tree, splits = rule.tree, rule.splits
    nodes = 2 * len(splits) + 1
    areas = [np.stack([group_sums(tree.leaf, column, nodes) for column in area.T], axis=1) for area in people]
    for s in reversed(range(len(splits))):
        for area in areas:
            area[tree.split_node[s]] = area[2 * s + 1] + area[2 * s + 2]
    is_paired = paired(tree.step)
    rows, target, weight = [], [], []
    for s, split in enumerate(splits):
        if split is None or split.late or split.features is None:
            continue
        sides = [(area[2 * s + 1], area[2 * s + 2]) for area in areas]
        all_pairs = sum(float(area[0].sum()) ** 2 for area in areas)
        pairs = sum(float(a.sum() * b.sum()) for a, b in sides)
        if pairs > 0.0:
            kept = np.array([min(split.priority, 1.0)])
            rows.append(order_features(kept, split.features[None], is_paired[s : s + 1])[0])
            target.append(sum(float((a * b).sum()) for a, b in sides) / pairs)
            weight.append((pairs / all_pairs) ** _SIZE_EXPONENT)
    return _rows(rows, target, weight, ORDER_FEATURES)


def _coarse(
    example: Example, parameters: SegmentationParameters, is_symmetric: bool
) -> tuple[CoarseGraph, list[FloatArray], np.random.Generator]:
    """Coarsen a mesh; find the areas (N, K) of the clusters in the segments of every person."""
    mesh = example.read_mesh()
    rng = np.random.default_rng(parameters.seed)
    whole = build_surface(mesh)
    coarse = coarse_graph(whole, parameters, rng, is_symmetric)
    parent, areas = coarse.refinement.parent, coarse.refinement.surface.areas
    people = [
        _areas(coarse.clusters, on_surface(whole, labels)[parent], areas)
        for labels in example.read_people(len(mesh.faces))
    ]
    return coarse, people, rng


def _rows(rows: Sequence[FloatArray], target: Sequence[float], weight: Sequence[float], names: tuple[str, ...]) -> Rows:
    if not rows:
        return Rows(np.empty((0, len(names))), np.empty(0), np.empty(0))
    weights = np.array(weight)
    return Rows(np.stack(rows), np.array(target), weights / weights.sum())


def _areas(clusters: Clusters, labels: LongArray, areas: FloatArray) -> FloatArray:
    """(N, K) area of every cluster in every segment of a person, without the faces of no part.

    Parameters
    ----------
    labels, areas : (F,) of the faces of the surface.
    """
    known = labels != NO_PART
    distinct, segment = np.unique(labels[known], return_inverse=True)
    cell = clusters.of_node[known].astype(np.int64) * len(distinct) + segment
    count = clusters.graph.node_count
    return group_sums(cell, areas[known], count * len(distinct)).reshape(count, len(distinct))


class _Recorder(LearnedRule):
    """The learned rule, which also records the features and the target of every candidate."""

    def __init__(
        self,
        fields: ClusterFields,
        parameters: SegmentationParameters,
        rng: np.random.Generator,
        people: list[FloatArray],
    ) -> None:
        super().__init__(fields, parameters, rng)
        self._people = people
        self.rows: list[FloatArray] = []
        self.target: list[float] = []
        self.weight: list[float] = []

    def best_split(self, segment: Segment, image: IntArray | None = None) -> Split:
        assert image is None
        inside = self._fields.inside(segment)
        candidates = self.candidates(segment, inside)
        features = self.features(segment, inside, candidates)
        best = self.best_for_bodies(inside, candidates, features)
        self._record(segment, candidates, features, best.cut)
        return best

    def _record(self, segment: Segment, candidates: Sequence[Cut], features: FloatArray, chosen: Cut) -> None:
        for row, cut in zip(features, candidates, strict=True):
            one, other = segment.nodes[cut.side], segment.nodes[~cut.side]
            areas = [(area[one].sum(axis=0), area[other].sum(axis=0)) for area in self._people]
            pairs = np.array([a.sum() * b.sum() for a, b in areas])
            if pairs.sum() > 0.0:
                self.rows.append(row)
                self.target.append(sum(float((a * b).sum()) for a, b in areas) / float(pairs.sum()))
                size = (cut.inside * cut.outside / self._total**2) ** _SIZE_EXPONENT
                self.weight.append(_CHOSEN_WEIGHT * size if cut is chosen else size)


class _Finisher(LearnedRule):
    """The learned rule, which also keeps the tree and its splits in the order in which they were made."""

    tree: Tree
    splits: Sequence[Split | None]

    def finished(self, tree: Tree, splits: Sequence[Split | None]) -> Tree:
        self.tree, self.splits = tree, splits
        return super().finished(tree, splits)
