"""Cuts whose two sides are connected."""

import numpy as np

from segcore.arrays import BoolArray, IntArray, group_sums
from segcore.graphs.cheeger import Cut, cut_of
from segcore.graphs.surface_graph import SurfaceGraph, connected_components


def with_connected_sides(graph: SurfaceGraph, cut: Cut) -> Cut:
    """Return a cut of a connected graph with two connected sides: the best (by NCC) that cuts off a piece of a cut.

    The pieces are the connected components of both sides. If the complement of the best piece is not connected, all of
    its components touch that piece. The complement of each of them is therefore connected, and the best of them is cut
    off instead.
    """
    pieces = _pieces(graph, cut.side)
    if pieces.max() <= 1:
        return cut
    best = _best_piece(graph, pieces)
    pieces = _pieces(graph, best.side)
    if pieces.max() <= 1:
        return best
    inside = pieces[np.argmax(best.side)]
    return _best_piece(graph, pieces, excluded=int(inside))


def _pieces(graph: SurfaceGraph, side: BoolArray) -> IntArray:
    """(N,) connected component of every node in the graph without the edges across the cut."""
    kept = side[graph.edges[:, 0]] == side[graph.edges[:, 1]]
    return connected_components(graph.edges[kept], graph.node_count)


def _best_piece(graph: SurfaceGraph, pieces: IntArray, excluded: int | None = None) -> Cut:
    """Cut off the piece with the least NCC against all other nodes."""
    count = int(pieces.max()) + 1
    ends = pieces[graph.edges]
    crossing = ends[:, 0] != ends[:, 1]
    border = group_sums(ends[crossing].ravel(), np.repeat(graph.weight[crossing], 2), count)
    volume = group_sums(pieces, graph.volume, count)
    smaller = np.minimum(volume, graph.total_volume - volume)
    ncc = np.divide(border, smaller, out=np.full(count, np.inf), where=smaller > 0)
    if excluded is not None:
        ncc[excluded] = np.inf
    return cut_of(graph, pieces == int(np.argmin(ncc)))
