"""Projection of a tree of cuts of the vertices of a mesh to a tree of cuts of its faces."""

from dataclasses import dataclass

import numpy as np

from segcore.arrays import BoolArray, FloatArray, IntArray, group_sums
from segcore.graphs.cheeger import cut_of
from segcore.graphs.connected_sides import with_connected_sides
from segcore.graphs.surface_graph import SurfaceGraph
from segcore.graphs.tree import LeafIntervals, Tree


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
        larger, smaller = 2 * len(split_node) - 1, 2 * len(split_node)
        one_is_larger = part.graph.volume[side].sum() >= part.graph.volume[~side].sum()
        parts[one] = part.half(side, larger if one_is_larger else smaller)
        parts[other] = part.half(~side, smaller if one_is_larger else larger)
        if split + 1 < tree.automatic_segments:
            automatic = len(split_node) + 1
    leaf = np.zeros(faces.node_count, dtype=np.int32)
    for part in parts.values():
        leaf[part.faces] = part.node
    return Tree(np.array(split_node, dtype=np.int32), np.array(cut_value), leaf, automatic)


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
    """(M,) the sides made connected; True stays on the side that shares the larger area with it."""
    connected = with_connected_sides(graph, cut_of(graph, side)).side
    kept = graph.volume[connected == side].sum()
    return connected if 2 * kept >= graph.total_volume else ~connected


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
