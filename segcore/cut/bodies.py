"""Bodies, that is connected components of a surface that touch, and cuts between the bodies of a segment.

A *piece* of a segment is a connected component of it without the contacts between bodies: a whole body, or the part of
one that is left after earlier cuts.
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import breadth_first_order, minimum_spanning_tree

from segcore.arrays import FloatArray, IntArray, group_sums
from segcore.graphs.cheeger import Cut, cut_of
from segcore.graphs.surface_graph import SurfaceGraph, connected_components
from segcore.graphs.tree import common_ancestors
from segcore.jit.decorators import kernel

MOST_CUTS = 8  # between pieces, that are compared by their features; set by hand
# A body is a speck below both of these shares, of the total area and of the area of the largest body, as in
# coarsen/components.py and coarsen/assembly.py.
_SPECK = 0.002
_NO_SPECK = 0.1
_MOST_PIECES = 1024  # of a segment, for which the cuts between them are searched; a limit of memory
_ALIKE_AREA = 0.05  # largest difference of the logarithms of the areas of two bodies that repeat; set by hand
_ALIKE_SHAPE = 0.05  # largest difference of their relative extents; set by hand


@dataclass(frozen=True, slots=True, eq=False)
class Bodies:
    """The bodies of the clusters of a graph."""

    of_cluster: IntArray  # (N,) the body 0..B - 1 of every cluster
    area: FloatArray  # (B,)
    repeats: IntArray  # (B,) the number of bodies of about the same size and proportions, itself included

    @classmethod
    def of(cls, of_cluster: IntArray, volume: FloatArray, points: FloatArray) -> "Bodies":
        """The bodies of clusters at ``points`` (N, 3) with areas ``volume`` (N,)."""
        area = group_sums(of_cluster, volume)
        if len(area) == 1:
            return cls(of_cluster, area, np.ones(1, dtype=np.int32))
        centre = np.stack([group_sums(of_cluster, volume * points[:, k]) / area for k in range(3)], axis=1)
        away = points - centre[of_cluster]
        moment = np.empty((len(area), 3, 3))
        for i in range(3):
            for j in range(3):
                moment[:, i, j] = group_sums(of_cluster, volume * away[:, i] * away[:, j]) / area
        extent = np.sqrt(np.maximum(np.linalg.eigvalsh(moment), 0.0)) / np.sqrt(area)[:, None]
        return cls(of_cluster, area, _alike(np.log(area), extent))

    @property
    def count(self) -> int:
        """The number of bodies that are no specks."""
        least = min(_SPECK * self.area.sum(), _NO_SPECK * self.area.max())
        return int(np.count_nonzero(self.area >= least))


@kernel
def _alike(log_area: FloatArray, extent: FloatArray) -> IntArray:
    """(B,) the number of bodies whose area and relative extents (B, 3) are about the same, itself included."""
    order = np.argsort(log_area)
    count = np.ones(len(log_area), dtype=np.int32)
    for p in range(len(order)):
        i = order[p]
        q = p + 1
        while q < len(order) and log_area[order[q]] - log_area[i] <= _ALIKE_AREA:
            j = order[q]
            difference = 0.0
            for k in range(3):
                difference = max(difference, abs(extent[i, k] - extent[j, k]))
            if difference <= _ALIKE_SHAPE:
                count[i] += 1
                count[j] += 1
            q += 1
    return count


def pieces_of(graph: SurfaceGraph, body: IntArray) -> IntArray:
    """(M,) the piece 0, 1, ... of every node of a segment with the bodies (M,)."""
    inside = body[graph.edges[:, 0]] == body[graph.edges[:, 1]]
    if inside.all():
        return np.zeros(graph.node_count, dtype=np.int32)
    return connected_components(graph.edges[inside], graph.node_count)


def cuts_between_pieces(graph: SurfaceGraph, piece: IntArray) -> list[Cut]:
    """At most ``MOST_CUTS`` cuts along contacts alone, of the least normalized Cheeger cut.

    They are the bipartitions that remove one edge of the spanning tree of the pieces with the largest contacts. Both of
    their sides are connected.

    Parameters
    ----------
    graph : connected.
    piece : (M,) the piece of every node, each connected.
    """
    count = int(piece.max()) + 1
    if not 1 < count <= _MOST_PIECES:
        return []
    ends = piece[graph.edges]
    across = ends[:, 0] != ends[:, 1]
    volume = group_sums(piece, graph.volume, count)
    pairs, weight = ends[across], graph.weight[across]
    place, end, parent = _spanning_tree(pairs, weight, count)
    # What a pair of pieces adds to the cut of a subtree that has both of them is subtracted where their paths meet.
    low, high = place[pairs].T
    common = common_ancestors(parent, low, high)
    added = group_sums(np.concatenate([low, high]), np.tile(weight, 2), count) - 2.0 * group_sums(common, weight, count)
    cut = _subtree_sums(added, end)[1:]  # without the whole tree
    below = _subtree_sums(group_sums(place, volume, count), end)[1:]
    ncc = cut / np.maximum(np.minimum(below, volume.sum() - below), np.finfo(float).tiny)
    chosen = np.argsort(ncc, kind="stable")[:MOST_CUTS]
    at = place[piece]
    return [cut_of(graph, (first <= at) & (at < end[first])).canonical for first in chosen + 1]


def _spanning_tree(pairs: IntArray, weight: FloatArray, count: int) -> tuple[IntArray, IntArray, IntArray]:
    """The maximum spanning tree of C pieces, as places 0, 1, ... such that those of every subtree are consecutive.

    Returns
    -------
    The places (C,) of the pieces; for every place the end (C,) of its subtree, and the place (C,) of its parent, which
    is smaller, or -1.
    """
    low, high = pairs.min(axis=1), pairs.max(axis=1)
    contact = coo_matrix((weight, (low, high)), shape=(count, count)).tocsr()
    contact.data = 1.0 / contact.data  # a minimum spanning tree of these is a maximum spanning tree of the weights
    tree = minimum_spanning_tree(contact)
    order, parent = breadth_first_order(tree, 0, directed=False)
    size = np.ones(count, dtype=np.int32)
    for node in order[:0:-1].tolist():
        size[parent[node]] += size[node]
    first = np.zeros(count, dtype=np.int32)
    free = first + 1
    for node in order[1:].tolist():
        above = parent[node]
        first[node] = free[above]
        free[above] += size[node]
        free[node] = first[node] + 1
    end, above = np.empty_like(first), np.full_like(first, -1)
    end[first] = first + size
    above[first[order[1:]]] = first[parent[order[1:]]]
    return first, end, above


def _subtree_sums(values: FloatArray, end: IntArray) -> FloatArray:
    """(C,) the sums of values (C,) over the subtrees of the places 0, 1, ..., which end before ``end``."""
    before = np.concatenate([[0.0], np.cumsum(values)])
    sums: FloatArray = before[end] - before[:-1]
    return sums
