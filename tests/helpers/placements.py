"""Leaves of random trees over the faces of a sphere, in the form that the kernels of segcore.label take."""

from dataclasses import dataclass

import numpy as np

from helpers.trees import grown_tree
from segcore import shapes
from segcore.arrays import IntArray
from segcore.clean.edge_geometry import edge_lengths
from segcore.clean.surface import build_surface
from segcore.graphs.tree import Tree
from segcore.label.leaves import Bounds, FaceGraph, Placement

SURFACE = build_surface(shapes.icosphere(2))
GRAPH = SURFACE.face_graph()
FACES = FaceGraph(GRAPH.edges, edge_lengths(SURFACE), GRAPH.rows())


@dataclass(frozen=True)
class Case:
    """A tree over the faces of the sphere, and the places of its leaves."""

    tree: Tree
    place: IntArray  # (F,)
    split_at: IntArray  # (K,)

    @classmethod
    def of(cls, leaves: int, seed: int) -> "Case":
        tree = grown_tree(GRAPH, leaves, seed)
        places = tree.leaf_intervals()
        split_at = np.zeros(leaves, np.int32)
        split_at[places.first[2::2]] = np.arange(leaves - 1)
        return cls(tree, places.first[tree.leaf], split_at)

    def bounds(self, split: int) -> Bounds:
        places = self.tree.leaf_intervals()
        return Bounds(
            int(places.first[2 * split + 1]), int(places.first[2 * split + 2]), int(places.end[2 * split + 2])
        )

    def placement(self, place: IntArray) -> Placement:
        """Count faces and crossing edges anew, one edge at a time."""
        crossings = np.zeros(len(self.tree.split_node), np.int64)
        for one, other in place[GRAPH.edges].tolist():
            if one != other:
                crossings[self.split_of(one, other)] += 1
        return Placement(place.copy(), np.bincount(place, minlength=len(self.split_at)), crossings, self.split_at)

    def split_of(self, one: int, other: int) -> int:
        """The split with the two places on different sides."""
        (split,) = (
            s for s in range(len(self.tree.split_node)) if {side_of(self.bounds(s), p) for p in (one, other)} == {0, 1}
        )
        return split


def side_of(bounds: Bounds, place: int) -> int:
    """0 on the lower side of a split, 1 on the upper side, -1 outside."""
    if not bounds.low <= place < bounds.high:
        return -1
    return int(place >= bounds.middle)


def neighbours(face: int) -> list[tuple[int, int]]:
    """The neighbours of a face, each with the edge to it, in the order of the rows."""
    start, neighbour, edge = FACES.rows
    row = slice(start[face], start[face + 1])
    return list(zip(neighbour[row].tolist(), edge[row].tolist(), strict=True))


def is_whole(place: IntArray, leaf: int) -> bool:
    """Whether the faces at a place are connected; also if there are none."""
    left = set(np.flatnonzero(place == leaf).tolist())
    waiting = [left.pop()] if left else []
    while waiting:
        found = {g for g, _ in neighbours(waiting.pop())} & left
        left -= found
        waiting += found
    return not left
