"""Groups of nodes that have come apart, made connected again."""

import numpy as np

from segcore.arrays import IntArray, group_sums, largest_options
from segcore.graphs.surface_graph import SurfaceGraph, components_inside, edges_between


def in_one_piece(graph: SurfaceGraph, group: IntArray, kind: IntArray) -> IntArray:
    """(N,) groups of which all pieces but the largest have joined a neighbouring group of the same kind.

    Of several neighbours the one with the longest border is taken. This is repeated, because a piece may have no other
    neighbours than such pieces. A piece without a neighbour of its kind stays.

    Parameters
    ----------
    group : (N,) the group 0..K - 1 of every node.
    kind : (K,) of every group.
    """
    while True:
        joined = _joined_once(graph, group, kind)
        if np.array_equal(joined, group):
            return joined
        group = joined


def _joined_once(graph: SurfaceGraph, group: IntArray, kind: IntArray) -> IntArray:
    piece = components_inside(graph.edges, group)
    volume = group_sums(piece, graph.volume)
    of_piece = np.empty(len(volume), dtype=np.int32)
    of_piece[piece] = group
    order = np.lexsort((-volume, of_piece))
    is_loose = np.ones(len(volume), dtype=bool)
    is_loose[order[np.unique(of_piece[order], return_index=True)[1]]] = False
    if not is_loose.any():
        return group
    edge = edges_between(graph.edges, is_loose[piece])
    ends = piece[graph.edges[edge]]
    one, other = np.concatenate([ends, ends[:, ::-1]]).T
    near = is_loose[one] & ~is_loose[other] & (kind[of_piece[one]] == kind[of_piece[other]])
    border = np.tile(graph.length[edge], 2)
    return largest_options(of_piece, one[near], of_piece[other[near]], border[near])[piece]
