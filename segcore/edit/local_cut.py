"""Exact minimum cuts among some nodes of a graph; the other nodes keep their sides."""

import numpy as np

from segcore.arrays import BoolArray, FloatArray
from segcore.graphs.inner_arcs import arcs_among
from segcore.graphs.max_flow import push
from segcore.graphs.surface_graph import Rows
from segcore.jit.decorators import kernel


def minimum_cut(
    rows: Rows, cost: FloatArray, inside: BoolArray, free: BoolArray, leaning: FloatArray | None = None
) -> BoolArray:
    """(N,) the set of least cost that agrees with ``inside`` at all nodes that are not free.

    The cost of a set is that of the edges that leave it, and the leaning of its nodes. Of several sets the largest is
    returned, up to rounding.

    Parameters
    ----------
    cost : (E,) of every edge, >= 0.
    inside : (N,) the nodes of a set.
    free : (N,) the nodes that may change.
    leaning : (N,) a cost of having a node in the set, negative if it belongs there.

    References
    ----------
    Boykov and Jolly, Interactive graph cuts for optimal boundary and region segmentation of objects, ICCV 2001.
    """
    nodes = np.flatnonzero(free).astype(np.int32)
    result: BoolArray = inside.copy()
    if len(nodes) == 0:
        return result
    arcs, capacity, excess = _network(rows, cost, inside, nodes, len(free))
    if leaning is not None:
        excess -= leaning[nodes]
    if excess.min() < 0.0 < excess.max():
        result[nodes] = push(arcs, capacity, excess) == len(nodes)
    elif excess.max() > 0.0:
        result[nodes] = True
    elif excess.min() < 0.0:
        result[nodes] = False
    return result


@kernel
def _network(rows, cost, inside, nodes, count):  # type: ignore[no-untyped-def]
    """The arcs between some nodes, their capacities, and the excess that the other nodes send and take."""
    start, neighbour, edge = rows
    local = np.full(count, -1, dtype=np.int32)
    for i in range(len(nodes)):
        local[nodes[i]] = i
    arcs, capacity = arcs_among(nodes, rows, cost, local, np.full(len(cost), -1, dtype=np.int32))
    excess = np.zeros(len(nodes))
    for i in range(len(nodes)):
        for k in range(start[nodes[i]], start[nodes[i] + 1]):
            if local[neighbour[k]] < 0:
                excess[i] += cost[edge[k]] if inside[neighbour[k]] else -cost[edge[k]]
    return arcs, capacity, excess
