"""Rules for splitting: the choice among several cuts, the order of the splits, and the automatic number of segments."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from segcore.arrays import BoolArray, FloatArray, IntArray
from segcore.clean.surface import Surface
from segcore.coarsen.clusters import Clusters
from segcore.coarsen.contacts import Links
from segcore.cut.bodies import cuts_between_pieces
from segcore.cut.equal_cuts import PartedBodies, equal_cuts, means_of_groups
from segcore.cut.features import FEATURES, cut_features
from segcore.cut.fields import ClusterFields, Segment, SegmentFields, cluster_fields
from segcore.cut.order import best_order_of_steps
from segcore.cut.symmetric_cuts import second_of_pair, symmetric_cuts, symmetric_sweeps
from segcore.graphs.cheeger import Cut, cut_of
from segcore.graphs.connected_sides import with_connected_sides
from segcore.graphs.ordering import minimum_degree, order_inside
from segcore.graphs.surface_graph import SurfaceGraph
from segcore.graphs.tree import Tree
from segcore.learned.models import learned_models
from segcore.parameters import SegmentationParameters
from segcore.solvers.flow import connected_sweeps
from segcore.solvers.solvers import SOLVERS

# Their neighbours are compared in bench/RESULTS.md, "Constants and their neighbours".
AUTOMATIC_NCUT = 1.44  # normalized cut times sqrt(total area) at which splitting ends, fitted for ``concavity``
SMALLEST_SIDE = 0.002  # share of the total area below which a part is cut off only after all others
SMALLEST_BODY = 0.0002  # share of the total area below which even a whole body is cut off only after all others
NCUT_WEIGHT = 0.4  # of the normalized cut beside the learned share in the comparison of candidates
# Learned share of kept pairs beyond which a cut is no sensible part any more; set by hand: nine of ten pairs.
MOST_KEPT = 0.9
# A shape is rarely one part: the people of every model of the benchmark separate 0.17 of the pairs or more on average.
# If the worthwhile splits separate less than a tenth of them, splits that keep six of ten pairs are worthwhile as well.
# Set by hand.
LEAST_SEPARATED = 0.1
MOST_KEPT_AT_FIRST = 0.6
# Factors on the learned share q of a cut between bodies, and on 1 - q of a cut through a body of several: bodies are
# parted before they are cut. Set by hand: see bench/RESULTS.md, "Authored assets".
BETWEEN_BODIES = 0.7
BETWEEN_LARGE_BODIES = 0.3  # if the smaller side has at least a tenth of the total area
LARGE_BODY = 0.1
THROUGH_BODY = 0.8
# Factor on the loss of a cut that cuts off what is congruent to bodies that were cut off before. Set by hand, as the
# weakest at which 110 bodies with equal limbs in different poses are all cut alike.
REPEATED = 0.7

_CONTACT_SHARE, _DIVIDED, _SMALL_WHOLE = (FEATURES.index(name) for name in ("contact_share", "divided", "small_whole"))
_SMALL_AREA = FEATURES.index("small_area")
_PIECES = [FEATURES.index("small_pieces"), FEATURES.index("large_pieces")]
_LEAST_CHANCE = 1e-4  # of a share whose log-odds are taken
# Features that tell the sets of assets apart rather than good cuts from bad ones: without them the models do better on
# sets that they have not seen.
OF_SETS = ("bodies", "mean_affinity", "small_confidence", "large_confidence")
SEVERAL_BODIES_FEATURES = tuple(name for name in FEATURES if name not in OF_SETS)
# kept: the log-odds of the share by the model of the cut. paired: 1 if the step cuts off the mirror image as well.
ORDER_FEATURES = ("kept", *SEVERAL_BODIES_FEATURES, "paired")
_ORDER_COLUMNS = [FEATURES.index(name) for name in SEVERAL_BODIES_FEATURES]
_NEARLY = 1e-6  # of a share of 0 or 1, for rounding


@dataclass(frozen=True, slots=True, eq=False)
class Split:
    """A split of a segment: its cut and its place among the other splits."""

    cut: Cut
    value: float  # normalized cut, or the ratio that orders the splits, times sqrt(total volume)
    priority: float  # splits are made by increasing priority
    late: bool  # True if the smaller side is so small that the split comes after all others
    image: BoolArray | None = None  # (N,) the second part that the same step cuts off, disjoint from S
    features: FloatArray | None = None  # (M,) of the cut; None if the rule does not need them

    def with_image(self, image: IntArray) -> "Split":
        """Return the split that also cuts off the mirror image of the side of the cut, if the two are a pair.

        Parameters
        ----------
        image : (N,) the mirror image of every node.
        """
        return replace(self, image=second_of_pair(self.cut.side, image))

    @property
    def second(self) -> "Split":
        """The split that cuts the image off the rest of a pair."""
        assert self.image is not None
        cut = self.cut
        return replace(self, cut=Cut(self.image, cut.weight, cut.inside, cut.outside - cut.inside), image=None)


class SplitRule(Protocol):
    """Chooses the splits of a tree."""

    @property
    def smallest_segment(self) -> float:
        """Area below which every split of a segment is a late one."""

    def best_split(self, segment: Segment, image: IntArray | None = None) -> Split:
        """Return the split of a segment of at least two nodes.

        Parameters
        ----------
        image : (M,) the place in the segment of the mirror image of every node, if the segment is its own image.
        """

    def is_sensible(self, late: bool, priority: float, /) -> bool:
        """Whether a split of a priority is worth making."""

    def best_among(self, segment: Segment, cuts: Sequence[Cut]) -> Split:
        """Return the split of a segment by the best of some cuts."""

    def finished(self, tree: Tree, splits: Sequence[Split | None]) -> Tree:
        """Return the tree in its final order with its automatic number of segments.

        Parameters
        ----------
        splits : (S,) None for splits between components, which come first. Splits of one step follow each other.
        """


def split_rule(
    surface: Surface, clusters: Clusters, links: Links, parameters: SegmentationParameters, rng: np.random.Generator
) -> SplitRule:
    """Return the rule that the parameters name; the learned one needs the thickness of the clusters.

    Parameters
    ----------
    links : between the components of the surface.
    """
    if parameters.split_order != "learned" or clusters.thickness is None:
        return RatioRule(clusters.graph, parameters, rng)
    return LearnedRule(cluster_fields(surface, clusters, links), parameters, rng)


class RatioRule:
    """The solver's cut; order by normalized cut, Cheeger cut or volume; a threshold of the normalized cut."""

    def __init__(self, graph: SurfaceGraph, parameters: SegmentationParameters, rng: np.random.Generator) -> None:
        self._parameters = parameters
        self._rng = rng
        self._total = graph.total_volume

    @property
    def smallest_segment(self) -> float:
        return 2.0 * SMALLEST_SIDE * self._total

    def best_split(self, segment: Segment, image: IntArray | None = None) -> Split:
        cut = SOLVERS[self._parameters.solver](segment.graph, self._parameters, self._rng)
        if image is not None:
            graph = segment.graph
            order = minimum_degree(graph.rows())
            symmetric = [*symmetric_cuts(graph, image, [cut.side]), *symmetric_sweeps(graph, image, order)]
            if symmetric:
                return self._split(segment, min(symmetric, key=lambda cut: cut.ncut)).with_image(image)
        return self._split(segment, with_connected_sides(segment.graph, cut))

    def is_sensible(self, late: bool, _priority: float, /) -> bool:
        return not late

    def best_among(self, segment: Segment, cuts: Sequence[Cut]) -> Split:
        return self._split(segment, min(cuts, key=lambda cut: cut.ncut))

    def _split(self, segment: Segment, cut: Cut) -> Split:
        order = self._parameters.split_order
        value = (cut.ncc if order == "ncc" else cut.ncut) * np.sqrt(self._total)
        priority = -segment.graph.total_volume if order == "volume" else value
        return Split(cut, value, priority, min(cut.inside, cut.outside) < SMALLEST_SIDE * self._total)

    def finished(self, tree: Tree, splits: Sequence[Split | None]) -> Tree:
        size = np.sqrt(self._total)
        starts = np.flatnonzero(np.diff(tree.step, prepend=-1)).tolist()  # the first splits of the steps
        enough = (s for s in starts if (split := splits[s]) and (split.late or split.cut.ncut * size >= AUTOMATIC_NCUT))
        return tree.reordered(range(len(splits)), next(enough, len(splits)) + 1)


class LearnedRule:
    """The cut, the order and the number of segments by the learned model of ``segcore.cut.features``."""

    def __init__(self, fields: ClusterFields, parameters: SegmentationParameters, rng: np.random.Generator) -> None:
        models = learned_models()
        model = models.split if fields.bodies.count == 1 else models.split_of_bodies
        self._model = model
        self._columns = [FEATURES.index(name) for name in model.names]
        self._order = models.order
        self._fields = fields
        self._parameters = parameters
        self._rng = rng
        self._total = fields.graph.total_volume
        self._elimination = minimum_degree(fields.graph.rows())
        self._parted = PartedBodies()

    @property
    def smallest_segment(self) -> float:
        share = SMALLEST_SIDE if self._fields.bodies.count == 1 else SMALLEST_BODY
        return 2.0 * share * self._total

    def best_split(self, segment: Segment, image: IntArray | None = None) -> Split:
        inside = self._fields.inside(segment)
        if image is not None and (symmetric := self._symmetric_candidates(segment, inside, image)):
            return self.best_of(symmetric, self.features(segment, inside, symmetric)).with_image(image)
        candidates = self.candidates(segment, inside)
        return self.best_for_bodies(inside, candidates, self.features(segment, inside, candidates))

    def is_sensible(self, late: bool, priority: float, /) -> bool:
        return not late and priority <= MOST_KEPT

    def best_among(self, segment: Segment, cuts: Sequence[Cut]) -> Split:
        return self.best_of(cuts, self.features(segment, self._fields.inside(segment), cuts))

    def best_of(self, candidates: Sequence[Cut], features: FloatArray, factor: FloatArray | None = None) -> Split:
        """Return the candidate of least learned share and normalized cut; a late one only if there is no other.

        Parameters
        ----------
        candidates : C cuts.
        features : (C, M)
        factor : (C,) on what is least.
        """
        kept = self._kept(features)
        size = np.sqrt(self._total)
        late = self._is_late(candidates, features)
        loss = kept + NCUT_WEIGHT * np.array([cut.ncut for cut in candidates]) * size
        if factor is not None:
            loss = factor * loss
        best = min(range(len(candidates)), key=lambda i: (late[i], loss[i]))
        cut = candidates[best]
        return Split(cut, cut.ncut * size, float(kept[best]), bool(late[best]), features=features[best])

    def best_for_bodies(self, inside: SegmentFields, candidates: Sequence[Cut], features: FloatArray) -> Split:
        """``best_of``, with a preference for cutting off bodies like those that were cut off other segments."""
        parts = self._parted.parts(inside, candidates, _between_bodies(features))
        best = self.best_of(candidates, features, np.where(self._parted.has(parts), REPEATED, 1.0))
        self._parted.add(parts[candidates.index(best.cut)])
        return best

    def candidates(self, segment: Segment, inside: SegmentFields) -> list[Cut]:
        """Return different cuts of a segment, each with connected sides."""
        graph = segment.graph
        if self._parameters.solver == "flow":
            order = order_inside(self._elimination, segment.nodes)
            sides = connected_sweeps(graph, order)
            cuts = [cut_of(graph, side) for side in sides]
        else:
            cuts = [with_connected_sides(graph, self._solved(graph)).canonical]
        between = cuts_between_pieces(graph, inside.piece)
        return list({cut.key: cut for cut in cuts + between}.values()) if between else cuts

    def _symmetric_candidates(self, segment: Segment, inside: SegmentFields, image: IntArray) -> list[Cut]:
        graph = segment.graph
        between = [cut.side for cut in cuts_between_pieces(graph, inside.piece)]
        if self._parameters.solver == "flow":
            order = order_inside(self._elimination, segment.nodes)
            return [*symmetric_sweeps(graph, image, order), *symmetric_cuts(graph, image, between)]
        return symmetric_cuts(graph, image, [self._solved(graph).side, *between])

    def _solved(self, graph: SurfaceGraph) -> Cut:
        return SOLVERS[self._parameters.solver](graph, self._parameters, self._rng)

    def features(self, segment: Segment, inside: SegmentFields, candidates: Sequence[Cut]) -> FloatArray:
        """(N, M) features of the candidates, see ``segcore.cut.features``."""
        return cut_features(self._fields, segment, inside, np.stack([cut.side for cut in candidates]))

    def _kept(self, features: FloatArray) -> FloatArray:
        """(N,) the share of the pairs across each candidate that people keep together."""
        kept = self._model.probability(np.ascontiguousarray(features[:, self._columns]))
        if self._fields.bodies.count == 1:
            return kept
        between = _between_bodies(features)
        several = np.expm1(features[:, _PIECES]).sum(axis=1) > 2.0 + _NEARLY  # one piece that is divided counts twice
        through = np.where(several, 1.0 - THROUGH_BODY * (1.0 - kept), kept)
        is_large = features[:, _SMALL_AREA] >= np.log(LARGE_BODY)
        return np.where(between, np.where(is_large, BETWEEN_LARGE_BODIES, BETWEEN_BODIES) * kept, through)

    def _kept_in_tree(self, splits: Sequence[Split], step: IntArray) -> FloatArray:
        """(S,) the share of the pairs across the splits of a tree that people keep together, again for the order.

        Parameters
        ----------
        step : (S,) of every split.
        """
        kept = np.array([split.priority for split in splits])
        if self._order is None or not splits:
            return kept
        again = self._order.estimate(order_features(kept, np.array([split.features for split in splits]), paired(step)))
        again = np.where([split.late for split in splits], np.maximum(again, MOST_KEPT), again)
        return np.where(kept > 1.0, kept, again)  # beyond 1: of a step that is not complete

    def _is_late(self, candidates: Sequence[Cut], features: FloatArray) -> BoolArray:
        smaller = np.array([min(cut.inside, cut.outside) for cut in candidates])
        is_body = _between_bodies(features) & (features[:, _SMALL_WHOLE] > 1.0 - _NEARLY)
        return smaller < np.where(is_body, SMALLEST_BODY, SMALLEST_SIDE) * self._total

    def finished(self, tree: Tree, splits: Sequence[Split | None]) -> Tree:
        apart = sum(split is None for split in splits)
        learned = [split for split in splits if split is not None]
        parent = np.maximum((tree.split_node[apart:] - 1) // 2 - apart, -1)
        # The cost of a split is the share of all pairs of points that it separates. Its gain is the part of them that
        # people separate, less the part that they keep together.
        pairs = np.array([2.0 * split.cut.inside * split.cut.outside / self._total**2 for split in learned])
        step = tree.step[apart:] - apart
        kept = self._kept_in_tree(learned, step)
        # Equal cuts have one share, so that all of them are worth making or none is; beyond 1 a step is not complete.
        equal = equal_cuts(self._fields.graph, self._fields.points, tree)[apart:]
        shared = means_of_groups(equal, kept, np.where(kept > 1.0, _NEARLY, 1.0) * pairs)
        gain = pairs * (1.0 - 2.0 * np.where(kept > 1.0, kept, shared))
        least = 0.0 if apart else LEAST_SEPARATED
        most_loss = 2.0 * MOST_KEPT_AT_FIRST - 1.0
        order, worthwhile = best_order_of_steps(step, parent, gain, pairs, least, most_loss)
        return tree.reordered([*range(apart), *(apart + s for s in order)], apart + worthwhile + 1)


def paired(step: IntArray) -> BoolArray:
    """(S,) True for the splits whose step (S,) has several, which are images of each other."""
    is_paired: BoolArray = np.bincount(step)[step] > 1
    return is_paired


def order_features(kept: FloatArray, features: FloatArray, is_paired: BoolArray) -> FloatArray:
    """(S, M) of ``ORDER_FEATURES`` for splits with the learned share (S,), the features of their cuts, and images."""
    chance = np.clip(kept, _LEAST_CHANCE, 1.0 - _LEAST_CHANCE)
    return np.column_stack([np.log(chance / (1.0 - chance)), features[:, _ORDER_COLUMNS], is_paired])


def _between_bodies(features: FloatArray) -> BoolArray:
    """(N,) True for cuts that are contact alone and divide no body."""
    return (features[:, _CONTACT_SHARE] > 1.0 - _NEARLY) & (features[:, _DIVIDED] < _NEARLY)
