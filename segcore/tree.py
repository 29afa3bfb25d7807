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
