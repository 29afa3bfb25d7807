"""The binary tree of cuts of the nodes of a graph."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from segcore.arrays import FloatArray, IntArray
from segcore.graphs.surface_graph import SurfaceGraph, connected_components
from segcore.hierarchy import renumbered_nodes
from segcore.nary import numbered_steps, own_steps


def common_ancestors(parent: IntArray, one: IntArray, other: IntArray) -> IntArray:
    """(P,) the last common ancestor of each pair of nodes of a tree.

    Parameters
    ----------
    parent : (N,) of every node, with a smaller number; that of the root does not matter.
    one, other : (P,) nodes.
    """
    a, b = one.copy(), other.copy()
    while len(apart := np.flatnonzero(a != b)):
        low, high = np.minimum(a[apart], b[apart]), np.maximum(a[apart], b[apart])
        a[apart], b[apart] = parent[high], low
    return a


@dataclass(frozen=True, slots=True, eq=False)
class LeafIntervals:
    """Places 0, 1, ... for the leaves of a tree, such that the leaves of every node have consecutive ones."""

    first: IntArray  # (2 S + 1,) the first place of every node; the place of a leaf
    end: IntArray  # (2 S + 1,) one more than the last place of every node


@dataclass(frozen=True, slots=True, eq=False)
class Tree:
    """The splits of the nodes of a graph, numbered as in :class:`segcore.hierarchy.Hierarchy`."""

    split_node: IntArray  # (S,)
    cut_value: FloatArray  # (S,) normalized cut times sqrt(total volume); 0 for splits between components
    leaf: IntArray  # (N,) the leaf of every node of the graph
    automatic_segments: int
    step: IntArray = field(default_factory=lambda: own_steps(0))  # (S,) the step of each split; see ``segcore.nary``
    limit_reached: bool = False  # whether the limit of the number of segments left sensible cuts out

    def __post_init__(self) -> None:
        """If no steps are given, every split is a step."""
        if len(self.step) == 0:
            object.__setattr__(self, "step", own_steps(len(self.split_node)))

    def reordered(self, order: Sequence[int], automatic_segments: int) -> "Tree":
        """Return the same splits in another order, parents before children.

        Parameters
        ----------
        order : (S,) the splits, first to last.
        """
        splits = np.asarray(order, dtype=np.int32)
        number = renumbered_nodes(splits)
        return replace(
            self,
            split_node=number[self.split_node[splits]],
            cut_value=self.cut_value[splits],
            leaf=number[self.leaf],
            automatic_segments=automatic_segments,
            step=numbered_steps(self.step[splits]),
        )

    def is_connected(self, graph: SurfaceGraph) -> bool:
        """True if the nodes below every split that is not free, and those of every leaf, are connected in a graph.

        Leaves are connected by the edges inside them, and the two sides of a split by an edge across it.
        """
        a, b = self.leaf[graph.edges].T
        pieces = int(connected_components(graph.edges[a == b], graph.node_count).max()) + 1
        if pieces > len(np.unique(self.leaf)):
            return False
        across = self.split_between(a[a != b], b[a != b])
        return len(np.unique(across)) == np.count_nonzero(self.cut_value > 0.0)

    def split_between(self, a: IntArray, b: IntArray) -> IntArray:
        """(E,) the split that separates two leaves, -1 if they are the same.

        Parameters
        ----------
        a, b : (E,) leaves.
        """
        split_of = np.full(2 * len(self.split_node) + 1, -1, dtype=np.int32)
        split_of[self.split_node] = np.arange(len(self.split_node))
        parent = np.concatenate([[-1], np.repeat(self.split_node, 2)])
        return split_of[common_ancestors(parent, a, b)]

    def leaf_intervals(self) -> LeafIntervals:
        """Return the places of the leaves: those of the first child of a node come before those of the second."""
        count = 2 * len(self.split_node) + 1
        leaves = np.ones(count, dtype=np.int32)
        for split in reversed(range(len(self.split_node))):
            leaves[self.split_node[split]] = leaves[2 * split + 1] + leaves[2 * split + 2]
        first = np.zeros(count, dtype=np.int32)
        for split, node in enumerate(self.split_node.tolist()):
            first[2 * split + 1] = first[node]
            first[2 * split + 2] = first[node] + leaves[2 * split + 1]
        return LeafIntervals(first, first + leaves)
