"""The parts of a hierarchy that contain a marked face, and what speaks for each of them."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from segcore.arrays import BoolArray, FloatArray, IntArray, group_sums
from segcore.edit.distances import distances_from_border
from segcore.edit.guide_graph import GuideGraph
from segcore.graphs.tree import Tree
from segcore.hierarchy import Hierarchy

FEATURES = (
    "is_whole",  # the part is the whole mesh
    "log_area",  # share of the total area
    "log_area_squared",
    "appears_earlier",  # min(0, log(level at which the part appears / automatic number))
    "appears_later",  # max(0, the same)
    "ends_earlier",  # min(0, log(level at which the part is cut / automatic number))
    "ends_later",  # max(0, the same)
    "is_automatic",  # the part is one of the automatic number
    "log_border",  # weight of its border over the square root of the smaller area
    "affinity",  # mean along its border
    "log_cut_value",  # of the cut that made it
    "log_own_cut_value",  # of the cut that divides it
    "is_leaf",
    "depth",  # distance of the marked face from the border over the largest distance in the part
    "log_life",  # log(level at which it is cut / level at which it appears)
)
_SMALL = 1e-3  # added to dimensionless numbers before their logarithm is taken
_NO_CUT = 5.0  # in place of the value of the cut that divides a leaf; set by hand


@dataclass(frozen=True, slots=True, eq=False)
class TreeParts:
    """The nodes of a hierarchy as sets of nodes of a graph."""

    graph: GuideGraph
    leaf: IntArray  # (N,) the leaf of every node of the graph
    parent: IntArray  # (T,) of every node of the hierarchy, -1 for the root
    first: IntArray  # (T,) the first place of the leaves below every node
    end: IntArray  # (T,) one more than the last
    place: IntArray  # (N,) the place of the leaf of every node of the graph
    area: FloatArray  # (T,)
    _constant: FloatArray = field(repr=False)  # (T, M) the features that do not depend on the marked face
    _depths: dict[int, tuple[IntArray, NDArray[np.float32]]] = field(default_factory=dict, repr=False)  # on demand

    @classmethod
    def of(cls, hierarchy: Hierarchy, graph: GuideGraph, leaf: IntArray) -> "TreeParts":
        """The parts of a hierarchy.

        Parameters
        ----------
        leaf : (N,) the leaf of every node of the graph.
        """
        tree = Tree(hierarchy.split_node, hierarchy.cut_value, leaf, hierarchy.automatic_segments)
        intervals = tree.leaf_intervals()
        area = _summed(hierarchy, group_sums(leaf, graph.area, hierarchy.node_count))
        constant = _constant_features(hierarchy, graph, tree, area)
        place = intervals.first[leaf]
        return cls(graph, leaf, hierarchy.parent, intervals.first, intervals.end, place, area, constant)

    def around(self, node: int) -> list[int]:
        """The parts that contain a node of the graph, from the smallest to the whole mesh."""
        parts = [int(self.leaf[node])]
        while self.parent[parts[-1]] >= 0:
            parts.append(int(self.parent[parts[-1]]))
        return parts

    def mask(self, part: int) -> BoolArray:
        """(N,) True for the nodes of the graph in a part."""
        return (self.place >= self.first[part]) & (self.place < self.end[part])

    def contains_any(self, part: int, nodes: IntArray) -> bool:
        """Whether a part has one of some nodes of the graph."""
        return bool(((self.place[nodes] >= self.first[part]) & (self.place[nodes] < self.end[part])).any())

    def contains_all(self, part: int, nodes: IntArray) -> bool:
        """Whether a part has all of some nodes of the graph."""
        return bool(((self.place[nodes] >= self.first[part]) & (self.place[nodes] < self.end[part])).all())

    def features(self, parts: list[int], node: int) -> FloatArray:
        """(P, M) the features of parts that contain a marked node of the graph."""
        values = self._constant[parts]
        values[:, FEATURES.index("depth")] = [self._depth(part, node) for part in parts]
        return values

    def _depth(self, part: int, node: int) -> float:
        if part not in self._depths:
            mask = self.mask(part)
            away = distances_from_border(self.graph.rows, self.graph.step, mask, np.inf)[mask]
            deepest = float(away[np.isfinite(away)].max(initial=0.0))
            share = np.where(np.isfinite(away), away, deepest) / deepest if deepest > 0.0 else np.ones(len(away))
            self._depths[part] = np.flatnonzero(mask).astype(np.int32), share.astype(np.float32)
        nodes, depth = self._depths[part]
        return float(depth[np.searchsorted(nodes, node)])


def _summed(hierarchy: Hierarchy, of_leaves: FloatArray) -> FloatArray:
    """(T,) sums over the leaves below every node of a hierarchy."""
    sums = of_leaves.copy()
    for split in reversed(range(len(hierarchy.split_node))):
        sums[hierarchy.split_node[split]] += sums[2 * split + 1] + sums[2 * split + 2]
    return sums


def _borders(hierarchy: Hierarchy, graph: GuideGraph, tree: Tree, values: FloatArray) -> FloatArray:
    """(T,) the sum of values of edges along the border of every part."""
    count = hierarchy.node_count
    ends = tree.leaf[graph.edges]
    across = ends[:, 0] != ends[:, 1]
    split = tree.split_between(ends[across, 0], ends[across, 1])
    at_ends = group_sums(ends[across].ravel(), np.repeat(values[across], 2), count)
    within = group_sums(hierarchy.split_node[split], values[across], count)
    border: FloatArray = _summed(hierarchy, at_ends) - 2.0 * _summed(hierarchy, within)
    return np.maximum(border, 0.0)


def _constant_features(hierarchy: Hierarchy, graph: GuideGraph, tree: Tree, area: FloatArray) -> FloatArray:
    count, automatic = hierarchy.node_count, float(hierarchy.automatic_segments)
    total = area[0]
    appears = hierarchy.level.astype(np.float64)
    ends = np.full(count, hierarchy.max_segments + 1.0)
    ends[hierarchy.split_node] = np.arange(len(hierarchy.split_node)) + 2.0
    own = np.full(count, _NO_CUT)
    own[hierarchy.split_node] = hierarchy.cut_value
    made = np.concatenate([[0.0], np.repeat(hierarchy.cut_value, 2)])
    weight, length = (_borders(hierarchy, graph, tree, values) for values in (graph.weight, graph.length))
    log_area = np.log(np.maximum(area / total, 1e-9))
    earlier, later = np.log(appears / automatic), np.log(ends / automatic)
    smaller = np.maximum(np.minimum(area, total - area), 1e-12)
    is_whole = np.arange(count) == 0
    is_leaf = np.ones(count, dtype=bool)
    is_leaf[hierarchy.split_node] = False
    columns = {
        "is_whole": is_whole,
        "log_area": log_area,
        "log_area_squared": log_area**2,
        "appears_earlier": np.minimum(earlier, 0.0),
        "appears_later": np.maximum(earlier, 0.0),
        "ends_earlier": np.minimum(later, 0.0),
        "ends_later": np.maximum(later, 0.0),
        "is_automatic": (appears <= automatic) & (ends > automatic),
        "log_border": np.where(is_whole, 0.0, np.log(_SMALL + weight / np.sqrt(smaller))),
        "affinity": weight / np.maximum(length, 1e-12),
        "log_cut_value": np.log(_SMALL + made),
        "log_own_cut_value": np.log(_SMALL + own),
        "is_leaf": is_leaf,
        "depth": np.zeros(count),
        "log_life": np.log(ends / appears),
    }
    return np.stack([np.asarray(columns[name], dtype=np.float64) for name in FEATURES], axis=1)
