"""Rows for the split model: for every candidate cut of a tree, the share of the separated pairs that people join."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from bench.assets.dataset import NO_PART
from bench.datasets import on_surface
from bench.learning.rows import Rows
from segcore.affinity.mesh_graphs import mesh_graph
from segcore.arrays import group_sums
from segcore.clean.refinement import refine
from segcore.clean.surface import build_surface
from segcore.coarsen.assembly import assemble
from segcore.coarsen.clusters import MOST_COMPONENTS, Clusters, cluster_nodes
from segcore.cut.bisection import bisect
from segcore.cut.features import FEATURES
from segcore.cut.fields import ClusterFields, Segment, cluster_fields
from segcore.cut.rules import LearnedRule, Split
from segcore.parameters import USUAL_SEGMENTS, SegmentationParameters

if TYPE_CHECKING:
    from bench.learning.examples import Example
    from segcore.arrays import FloatArray, IntArray, LongArray
    from segcore.graphs.cheeger import Cut


# Exponent of the share of all pairs that a cut separates, in the weight of its row. Set by hand, between equal weights
# (0) and weights by pairs (1), which the first cuts of each tree would dominate.
_SIZE_EXPONENT = 0.75
# Of the candidate that is taken, beside the others: the least of several estimates is too low on average. Set by hand.
_CHOSEN_WEIGHT = 4.0


def cut_rows(example: Example, seed: int = 0) -> Rows:
    """Grow the tree of a mesh with the learned models in use, and compare every candidate cut with the people.

    Pairs of points count by area. Cuts that separate no pair of points with a label are left out.
    """
    mesh = example.read_mesh()
    parameters = SegmentationParameters(seed=seed, max_segments=USUAL_SEGMENTS)
    rng = np.random.default_rng(seed)
    whole = build_surface(mesh)
    refinement = refine(whole)
    surface = refinement.surface
    nodes = mesh_graph(surface, parameters, refinement.is_piece)
    clusters, _ = assemble(surface, nodes, cluster_nodes(nodes, parameters.clusters, rng), MOST_COMPONENTS)
    people = [
        _areas(clusters, on_surface(whole, labels)[refinement.parent], surface.areas)
        for labels in example.read_people(len(mesh.faces))
    ]
    rule = _Recorder(cluster_fields(surface, clusters), parameters, rng, people)
    bisect(clusters.graph, clusters.points, rule, USUAL_SEGMENTS)
    if not rule.rows:
        return Rows(np.empty((0, len(FEATURES))), np.empty(0), np.empty(0))
    weight = np.array(rule.weight)
    return Rows(np.stack(rule.rows), np.array(rule.target), weight / weight.sum())


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
        best = self.best_of(candidates, features)
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
