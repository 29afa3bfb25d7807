"""Cuts whose two sides are connected."""

import numpy as np

from segcore.arrays import BoolArray, IntArray, group_sums
from segcore.graphs.cheeger import Cut, cut_of
from segcore.graphs.surface_graph import SurfaceGraph, connected_components


def with_connected_sides(graph: SurfaceGraph, cut: Cut) -> Cut:
    """The best cut (by NCC) of a connected graph that parts off one of the connected pieces that a cut leaves.

    The complement of a piece can itself fall apart. Its pieces then all touch the one taken first, so that any of them
    has a connected complement, and the best of them is taken.
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
    """(N,) the connected piece of every node when the edges across the cut are taken away."""
    kept = side[graph.edges[:, 0]] == side[graph.edges[:, 1]]
    return connected_components(graph.edges[kept], graph.node_count)


def _best_piece(graph: SurfaceGraph, pieces: IntArray, excluded: int = -1) -> Cut:
    """The piece with the least NCC against everything else."""
    count = int(pieces.max()) + 1
    ends = pieces[graph.edges]
    crossing = ends[:, 0] != ends[:, 1]
    border = group_sums(ends[crossing].ravel(), np.repeat(graph.weight[crossing], 2), count)
    volume = group_sums(pieces, graph.volume, count)
    ncc = border / np.minimum(volume, graph.total_volume - volume)
    if excluded >= 0:
        ncc[excluded] = np.inf
    return cut_of(graph, pieces == int(np.argmin(ncc)))
