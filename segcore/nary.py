"""Steps of a binary tree of cuts, and the n-ary tree that they describe.

Equal parts, such as the four legs of a table, are cut off by several splits that belong to one step. If the split that
makes a node and the split that cuts it belong to the same step, the node is passed over: its parts are shown beside the
other parts of the node above it. The splits stay binary, and levels at any number of segments stay what they are.
"""

import numpy as np

from segcore.arrays import BoolArray, IntArray


def own_steps(splits: int) -> IntArray:
    """(S,) steps of one split each."""
    return np.arange(splits, dtype=np.int32)


def numbered_steps(step: IntArray) -> IntArray:
    """(S,) the same steps, numbered 0, 1, ... in the order of their first splits.

    Parameters
    ----------
    step : (S,) any numbers that are equal for the splits of a step.
    """
    _, first, which = np.unique(step, return_index=True, return_inverse=True)
    rank = np.empty(len(first), dtype=np.int32)
    rank[np.argsort(first)] = np.arange(len(first))
    return rank[which]


def joined_splits(split_node: IntArray, step: IntArray) -> BoolArray:
    """(S,) True for the splits of the same step as the split that made the node that they cut.

    Parameters
    ----------
    split_node, step : (S,) as in :class:`segcore.hierarchy.Hierarchy`.
    """
    made_by = (split_node - 1) // 2
    joined: BoolArray = (made_by >= 0) & (step[made_by] == step)
    return joined


def nary_children(split_node: IntArray, step: IntArray) -> list[list[int]]:
    """The children of every node in the n-ary tree; none for leaves and for nodes that are passed over.

    The children of a node are the leaves of the largest subtree below it whose splits all belong to the step of the
    split of the node. They are in the order of their labels: the first one has the label of the node.

    Parameters
    ----------
    split_node, step : (S,) as in :class:`segcore.hierarchy.Hierarchy`. The first k - 1 entries of both give the tree of
        the k segments at that level.

    Returns
    -------
    A list of 2 S + 1 lists of nodes.
    """
    joined = joined_splits(split_node, step).tolist()
    passed_over = {node for node, is_joined in zip(split_node.tolist(), joined, strict=True) if is_joined}
    count = 2 * len(split_node) + 1
    label, shown = [0] * count, list(range(count))  # shown: the node itself, or the one that it is passed over for
    children: list[list[int]] = [[] for _ in range(count)]
    for split, node in enumerate(split_node.tolist()):
        larger, smaller = 2 * split + 1, 2 * split + 2
        label[larger], label[smaller] = label[node], split + 1
        for child in (larger, smaller):
            if child in passed_over:
                shown[child] = shown[node]
            else:
                children[shown[node]].append(child)
    return [sorted(nodes, key=label.__getitem__) for nodes in children]
