"""From a tree of cuts of the nodes of a mesh graph to a tree of cuts of the faces of the mesh."""

import numpy as np

from segcore.arrays import BoolArray, IntArray
from segcore.cheeger import cut_of
from segcore.graph import SurfaceGraph
from segcore.recursion import Tree, with_connected_sides


def project(tree: Tree, corners: IntArray, faces: SurfaceGraph) -> Tree:
    """Carry a tree of cuts over to the faces, so that every segment is a connected set of faces.

    Split by split, the faces of a node take the side of most of their corners. Then both sides are made connected. A
    split that no face follows is left out.

    Parameters
    ----------
    tree : a tree over the nodes of a graph.
    corners : (F, C) the nodes of every face.
    faces : the face dual graph.

    Returns
    -------
    The tree over the faces.
    """
    if corners.shape[1] == 1:
        return Tree(tree.split_node, tree.cut_value, tree.leaf[corners[:, 0]], tree.automatic_segments)
    position, first, end = _intervals(tree)
    place = position[tree.leaf][corners]
    members: dict[int, IntArray] = {0: np.arange(len(corners), dtype=np.int32)}
    graphs = {0: faces}
    now = {0: 0}  # node of the given tree -> node of the new one
    split_node: list[int] = []
    cut_value: list[float] = []
    automatic = 1
    for split, node in enumerate(tree.split_node.tolist()):
        nodes, graph = members.pop(node), graphs.pop(node)
        children = (2 * split + 1, 2 * split + 2)
        side = _votes(place[nodes], *((first[child], end[child]) for child in children))
        if side.any() and not side.all() and tree.cut_value[split] > 0:
            side = with_connected_sides(graph, cut_of(graph, side)).side
        if side.all() or not side.any():
            kept, lost = children if side.all() else children[::-1]
            members[kept], graphs[kept], now[kept] = nodes, graph, now[node]
            members[lost], graphs[lost] = nodes[:0], graph.subgraph(nodes[:0])
            continue
        inside = graph.volume[side].sum() >= graph.volume[~side].sum()
        split_node.append(now[node])
        cut_value.append(float(tree.cut_value[split]))
        for child, part, larger in zip(children, (side, ~side), (inside, not inside), strict=True):
            local = np.flatnonzero(part).astype(np.int32)
            members[child], graphs[child] = nodes[local], graph.subgraph(local)
            now[child] = 2 * len(split_node) - (1 if larger else 0)
        if split + 1 < tree.automatic_segments:
            automatic = len(split_node) + 1
    leaf = np.zeros(len(corners), dtype=np.int32)
    for node, nodes in members.items():
        if len(nodes):
            leaf[nodes] = now[node]
    return Tree(np.array(split_node, dtype=np.int32), np.array(cut_value), leaf, automatic)


def _intervals(tree: Tree) -> tuple[IntArray, IntArray, IntArray]:
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


def _votes(place: IntArray, one: tuple[int, int], other: tuple[int, int]) -> BoolArray:
    """True where more corners lie in one interval than in the other; the first corner with a vote decides a tie."""
    for_one = (one[0] <= place) & (place < one[1])
    for_other = (other[0] <= place) & (place < other[1])
    lead = for_one.sum(axis=1) - for_other.sum(axis=1)
    voting = np.argmax(for_one | for_other, axis=1)
    decided: BoolArray = (lead > 0) | ((lead == 0) & for_one[np.arange(len(place)), voting])
    return decided
