"""Projection of a tree of cuts of the vertices of a mesh to a tree of cuts of its faces."""

from dataclasses import dataclass

import numpy as np

from segcore.arrays import BoolArray, FloatArray, IntArray, group_sums
from segcore.graphs.surface_graph import SurfaceGraph, components_within
from segcore.graphs.tree import LeafIntervals, Tree
from segcore.nary import numbered_steps


@dataclass(frozen=True, slots=True, eq=False)
class Votes:
    """What decides on which side of a split a face is: the sides of some nodes of a graph, weighted."""

    face: IntArray  # (N,) ascending, every face 0..F - 1 at least once
    node: IntArray  # (N,) of the graph over which the tree is
    weight: FloatArray  # (N,)

    @classmethod
    def of_corners(cls, corners: IntArray) -> "Votes":
        """One vote for every corner of a face; the corners (F, 3) are nodes."""
        return cls(np.repeat(np.arange(len(corners), dtype=np.int32), 3), corners.ravel(), np.ones(corners.size))


def project(tree: Tree, votes: Votes, faces: SurfaceGraph) -> Tree:
    """Carry a tree of cuts over to the faces, such that every segment is a connected set of faces.

    Split by split, the faces of a node take the side for which most of the weight of their votes is. Then both sides
    are made connected. A split with no faces on one side is left out.

    Parameters
    ----------
    tree : a tree over the nodes of a graph.
    faces : the face dual graph.

    Returns
    -------
    The tree over the faces.
    """
    places = tree.leaf_intervals()
    place = places.first[tree.leaf][votes.node]
    parts = {0: _Part(np.arange(faces.node_count, dtype=np.int32), faces, 0, votes.face, place, votes.weight)}
    split_node: list[int] = []
    cut_value: list[float] = []
    kept: list[int] = []
    automatic = 1
    for split, node in enumerate(tree.split_node.tolist()):
        if node not in parts:
            continue
        part = parts.pop(node)
        one, other = 2 * split + 1, 2 * split + 2
        side = _votes(part, places, one, other)
        if side.all() or not side.any():
            parts[one if side.all() else other] = part
            continue
        if tree.cut_value[split] > 0:
            side = _connected(part.graph, side)
        split_node.append(part.node)
        cut_value.append(float(tree.cut_value[split]))
        kept.append(split)
        larger, smaller = 2 * len(split_node) - 1, 2 * len(split_node)
        one_is_larger = part.graph.volume[side].sum() >= part.graph.volume[~side].sum()
        parts[one] = part.half(side, larger if one_is_larger else smaller)
        parts[other] = part.half(~side, smaller if one_is_larger else larger)
        if split + 1 < tree.automatic_segments:
            automatic = len(split_node) + 1
    leaf = np.zeros(faces.node_count, dtype=np.int32)
    for part in parts.values():
        leaf[part.faces] = part.node
    step = numbered_steps(tree.step[kept])
    return Tree(np.array(split_node, dtype=np.int32), np.array(cut_value), leaf, automatic, step, tree.limit_reached)


@dataclass(frozen=True, slots=True, eq=False)
class _Part:
    """The faces of a node of the tree over the nodes, and their votes."""

    faces: IntArray  # (M,)
    graph: SurfaceGraph  # the face dual graph of these faces
    node: int  # their node in the tree over the faces
    voter: IntArray  # (N,) ascending: the place among ``faces`` of the face of every vote
    place: IntArray  # (N,) of the leaf of the node that votes
    weight: FloatArray  # (N,)

    def half(self, side: BoolArray, node: int) -> "_Part":
        local = np.flatnonzero(side).astype(np.int32)
        number = np.cumsum(side, dtype=np.int32) - 1
        votes = side[self.voter]
        return _Part(
            self.faces[local],
            self.graph.subgraph(local),
            node,
            number[self.voter[votes]],
            self.place[votes],
            self.weight[votes],
        )


def _connected(graph: SurfaceGraph, side: BoolArray) -> BoolArray:
    """(M,) the sides made connected: the largest piece of each stays, and the other pieces join what surrounds them.

    A piece that touches nothing, because its component was merged with another one, stays on its side.
    """
    piece, count = components_within(graph.edges, side)
    if count <= 2:
        return side
    volume = group_sums(piece, graph.volume, count)
    is_on_side = np.zeros(count, dtype=np.bool_)
    is_on_side[piece] = side
    owner = np.full(count, -1)
    for which in (0, 1):
        owner[np.argmax(np.where(is_on_side == which, volume, 0.0))] = which
    ends = piece[graph.edges]
    while True:
        reached = (owner[ends] >= 0).sum(axis=1) == 1
        if not reached.any():
            break
        known = owner[ends[reached]].max(axis=1)
        new = ends[reached][owner[ends[reached]] < 0]
        border = [group_sums(new, np.where(known == which, graph.length[reached], 0.0), count) for which in (0, 1)]
        owner = np.where((owner < 0) & (border[0] + border[1] > 0.0), border[1] > border[0], owner)
    connected: BoolArray = np.where(owner < 0, is_on_side, owner == 1)[piece]
    return connected


def _votes(part: _Part, places: LeafIntervals, one: int, other: int) -> BoolArray:
    """(M,) True for faces with more votes for one node than for the other; the first vote decides a tie."""
    for_one = (places.first[one] <= part.place) & (part.place < places.end[one])
    for_other = (places.first[other] <= part.place) & (part.place < places.end[other])
    count = len(part.faces)
    lead = group_sums(part.voter, part.weight * (1.0 * for_one - for_other), count)
    first = np.zeros(count, dtype=bool)
    voting = np.flatnonzero(for_one | for_other)[::-1]
    first[part.voter[voting]] = for_one[voting]
    decided: BoolArray = (lead > 0) | ((lead == 0) & first)
    return decided
