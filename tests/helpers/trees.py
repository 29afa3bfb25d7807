"""Trees of cuts for the tests of segcore: random ones, and the nodes below each node."""

import numpy as np

from segcore.arrays import BoolArray
from segcore.graphs.surface_graph import SurfaceGraph
from segcore.graphs.tree import Tree


def two_sides(side: BoolArray) -> Tree:
    """A tree of one split: True becomes leaf 1, False becomes leaf 2."""
    return Tree(np.zeros(1, np.int32), np.ones(1), np.where(side, 1, 2).astype(np.int32), 2)


def grown_tree(graph: SurfaceGraph, leaves: int, seed: int) -> Tree:
    """A random tree over a connected graph in which every node of the tree is a connected set of nodes of the graph.

    The leaves are grown from random nodes and merged with random neighbours.
    """
    rng = np.random.default_rng(seed)
    rows = graph.rows()
    leaf_of = np.full(graph.node_count, -1)
    fringe = list(rng.choice(graph.node_count, leaves, replace=False))
    leaf_of[fringe] = np.arange(leaves)
    while fringe:
        f = fringe.pop(rng.integers(len(fringe)))
        for g in rows.neighbour[rows.start[f] : rows.start[f + 1]]:
            if leaf_of[g] < 0:
                leaf_of[g] = leaf_of[f]
                fringe.append(g)
    group, merges = np.arange(leaves), []
    while len(set(group)) > 1:
        ends = group[leaf_of[graph.edges]]
        ends = ends[ends[:, 0] != ends[:, 1]]
        a, b = ends[rng.integers(len(ends))]
        merges.append((a, b, leaves + len(merges)))
        group[(group == a) | (group == b)] = merges[-1][2]
    number, split_node = {merges[-1][2] if merges else 0: 0}, []
    for a, b, into in reversed(merges):
        split_node.append(number[into])
        number[a], number[b] = 2 * len(split_node) - 1, 2 * len(split_node)
    leaf = np.array([number[i] for i in range(leaves)], np.int32)[leaf_of]
    return Tree(np.array(split_node, np.int32), np.ones(len(split_node)), leaf, 1)


def leaves_below(tree: Tree) -> list[set[int]]:
    """The leaves below every node of a tree; a leaf is below itself."""
    below = [{node} for node in range(2 * len(tree.split_node) + 1)]
    for split in reversed(range(len(tree.split_node))):
        below[int(tree.split_node[split])] = below[2 * split + 1] | below[2 * split + 2]
    return below


def members(tree: Tree) -> list[BoolArray]:
    """(N,) masks of the nodes of the graph that belong to every node of a tree."""
    return [np.isin(tree.leaf, list(leaves)) for leaves in leaves_below(tree)]
