"""The arcs between some nodes of a graph, for a maximum flow that only these nodes take part in."""

import numpy as np

from segcore.graphs.max_flow import Arcs
from segcore.jit.decorators import inner_kernel


@inner_kernel
def arcs_among(nodes, rows, weight, local, arc_of):  # type: ignore[no-untyped-def]
    """The arcs between some nodes, in the order of the nodes and their rows, and their capacities.

    Parameters
    ----------
    nodes : (L,)
    rows : the adjacency lists of the graph of N nodes and E edges.
    weight : (E,) the capacity of every edge.
    local : (N,) the place of each of the nodes in ``nodes``, -1 for all others.
    arc_of : (E,) work array, -1 before and after.
    """
    start, neighbour, edge_of = rows
    arcs = 0
    for node in nodes:
        for entry in range(start[node], start[node + 1]):
            if local[neighbour[entry]] >= 0:
                arcs += 1
    begin = np.empty(len(nodes) + 1, dtype=np.uint32)
    target = np.empty(arcs, dtype=np.uint32)
    reverse = np.empty(arcs, dtype=np.uint32)
    capacity = np.empty(arcs)
    count = 0
    for i in range(len(nodes)):
        begin[i] = count
        for entry in range(start[nodes[i]], start[nodes[i] + 1]):
            other, edge = local[neighbour[entry]], edge_of[entry]
            if other < 0:
                continue
            target[count] = other
            capacity[count] = weight[edge]
            if arc_of[edge] < 0:
                arc_of[edge] = count
            else:
                reverse[count] = arc_of[edge]
                reverse[arc_of[edge]] = count
                arc_of[edge] = -1
            count += 1
    begin[len(nodes)] = count
    return Arcs(begin, target, reverse), capacity
