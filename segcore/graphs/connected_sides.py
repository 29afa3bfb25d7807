"""Cuts whose two sides are connected."""

import numpy as np

from segcore.arrays import BoolArray, IntArray
from segcore.graphs.cheeger import Cut, cut_of, ncc_of
from segcore.graphs.surface_graph import SurfaceGraph, components_within
from segcore.jit.decorators import inner_kernel, kernel


def with_connected_sides(graph: SurfaceGraph, cut: Cut) -> Cut:
    """Return a cut of a connected graph with two connected sides: the best (by NCC) that cuts off a piece of a cut.

    The pieces are the connected components of both sides. If the complement of the best piece is not connected, all of
    its components touch that piece. The complement of each of them is therefore connected, and the best of them is cut
    off instead.
    """
    return cut_of(graph, connected_side(graph, cut.side))


@kernel
def connected_side(graph: SurfaceGraph, side: BoolArray) -> BoolArray:
    """(N,) ``with_connected_sides`` of the side (N,) of a cut."""
    pieces, count = components_within(graph.edges, side)
    if count <= 2:
        return side
    best = pieces == _best_piece(graph, pieces, count, np.int32(-1))
    pieces, count = components_within(graph.edges, best)
    if count <= 2:
        return best
    inside = pieces[np.argmax(best)]
    return pieces == _best_piece(graph, pieces, count, inside)


@inner_kernel
def _best_piece(graph: SurfaceGraph, pieces: IntArray, count: int, excluded: int) -> int:
    """The piece with the least NCC against all other nodes."""
    border, volume = np.zeros(count), np.zeros(count)
    for e in range(len(graph.edges)):
        a, b = pieces[graph.edges[e, 0]], pieces[graph.edges[e, 1]]
        if a != b:
            border[a] += graph.weight[e]
            border[b] += graph.weight[e]
    total = 0.0
    for i in range(len(pieces)):
        volume[pieces[i]] += graph.volume[i]
        total += graph.volume[i]
    best, least = 0, np.inf
    for p in range(count):
        ncc = ncc_of(border[p], volume[p], total - volume[p])
        if p != excluded and ncc < least:
            best, least = p, ncc
    return best
