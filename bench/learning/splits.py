"""Rows for the split model: for every candidate cut of a tree, the share of the separated pairs that people join."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from bench.learning.rows import Rows
from segcore.affinity.mesh_graphs import mesh_graph
from segcore.clean.surface import build_surface
from segcore.coarsen.assembly import assemble
from segcore.coarsen.clusters import cluster_nodes
from segcore.cut.bisection import bisect
from segcore.cut.features import ClusterFields, Segment
from segcore.cut.rules import LearnedRule, Split
from segcore.parameters import SegmentationParameters

if TYPE_CHECKING:
    from bench.princeton.dataset import Model
    from segcore.arrays import FloatArray, IntArray, LongArray

SEGMENTS = 64  # of the trees that are learned from: the default of max_segments
# Exponent of the share of all pairs that a cut separates, in the weight of its row. Set by hand, between equal weights
# (0) and weights by pairs (1), which the first cuts of each tree would dominate.
_SIZE_EXPONENT = 0.75


def cut_rows(model: Model, seed: int = 0) -> Rows:
    """Grow the tree of a model with the learned models in use, and compare every candidate cut with the people."""
    mesh = model.read_mesh()
    parameters = SegmentationParameters(seed=seed, affinity="learned")
    rng = np.random.default_rng(seed)
    surface = build_surface(mesh)
    nodes = mesh_graph(surface, parameters)
    clusters, _ = assemble(surface, nodes, cluster_nodes(nodes, parameters.clusters, rng), parameters.max_segments)
    labels_of_people = model.read_people(len(mesh.faces))
    people = [_face_counts(clusters.of_node[surface.face_of_input], labels) for labels in labels_of_people]
    assert clusters.thickness is not None
    fields = ClusterFields.of(clusters.graph, clusters.points, clusters.thickness)
    rule = _Recorder(fields, parameters, rng, people)
    bisect(clusters.graph, clusters.points, rule, SEGMENTS)
    weight = np.array(rule.pairs) ** _SIZE_EXPONENT
    return Rows(np.stack(rule.rows), np.array(rule.target), weight / weight.sum())


def _face_counts(cluster: IntArray, labels: LongArray) -> FloatArray:
    """(N, K) number of faces of every cluster in every segment of a person."""
    distinct, segment = np.unique(labels, return_inverse=True)
    count = int(cluster.max()) + 1
    cells = np.bincount(cluster.astype(np.int64) * len(distinct) + segment, minlength=count * len(distinct))
    return cells.reshape(count, len(distinct)).astype(np.float64)


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
        self.pairs: list[float] = []

    def best_split(self, segment: Segment, _image: IntArray | None = None) -> Split:
        candidates = self.candidates(segment)
        features = self.features(segment, candidates)
        self.rows += list(features)
        for cut in candidates:
            one, other = segment.nodes[cut.side], segment.nodes[~cut.side]
            shares = [_kept(faces[one].sum(axis=0), faces[other].sum(axis=0)) for faces in self._people]
            self.target.append(float(np.mean(shares)))
            self.pairs.append(cut.inside * cut.outside / self._total**2)
        return self.best_of(candidates, features)


def _kept(one: FloatArray, other: FloatArray) -> float:
    """Return the share of the pairs across a cut that are in one segment, from the faces (K,) on each side of it."""
    return float(np.dot(one, other) / max(one.sum() * other.sum(), 1.0))
