"""The binary tree of cuts of the nodes of a graph."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from segcore.arrays import FloatArray, IntArray
from segcore.hierarchy import renumbered_nodes


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

    def reordered(self, order: Sequence[int], automatic_segments: int) -> "Tree":
        """Return the same splits in another order, parents before children.

        Parameters
        ----------
        order : (S,) the splits, first to last.
        """
        splits = np.asarray(order, dtype=np.int32)
        number = renumbered_nodes(splits)
        return Tree(number[self.split_node[splits]], self.cut_value[splits], number[self.leaf], automatic_segments)

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
