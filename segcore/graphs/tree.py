"""The tree of cuts of the nodes of a graph."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from segcore.arrays import FloatArray, IntArray
from segcore.hierarchy import renumbered_nodes


@dataclass(frozen=True, slots=True, eq=False)
class Tree:
    """The splits of the nodes of a graph, numbered as in :class:`segcore.hierarchy.Hierarchy`."""

    split_node: IntArray  # (S,)
    cut_value: FloatArray  # (S,) normalized cut times sqrt(total volume); 0 where components part
    leaf: IntArray  # (N,) the leaf of every node of the graph
    automatic_segments: int

    def reordered(self, order: Sequence[int], automatic_segments: int) -> "Tree":
        """The same splits made in another order, parents still before children.

        Parameters
        ----------
        order : (S,) the splits, first to last.
        """
        splits = np.asarray(order, dtype=np.int32)
        number = renumbered_nodes(splits)
        return Tree(number[self.split_node[splits]], self.cut_value[splits], number[self.leaf], automatic_segments)


def intervals(tree: Tree) -> tuple[IntArray, IntArray, IntArray]:
    """A numbering of the leaves in which every node has consecutive ones: number of a leaf, first and end of a node."""
    count = 2 * len(tree.split_node) + 1
    leaves = np.ones(count, dtype=np.int32)
    for split in reversed(range(len(tree.split_node))):
        leaves[tree.split_node[split]] = leaves[2 * split + 1] + leaves[2 * split + 2]
    first = np.zeros(count, dtype=np.int32)
    for split, node in enumerate(tree.split_node.tolist()):
        first[2 * split + 1] = first[node]
        first[2 * split + 2] = first[node] + leaves[2 * split + 1]
    return first, first, first + leaves
