"""Maximum flows between sources and sinks that are spread over all nodes of a graph."""

from typing import NamedTuple

import numpy as np

from segcore.arrays import BoolArray, FloatArray, IntArray
from segcore.graphs.laplacian import LaplacianFactor, factor_of, substitute
from segcore.graphs.ordering import minimum_degree
from segcore.graphs.surface_graph import IndexArray, SurfaceGraph, rows_of_edges
from segcore.jit.decorators import inner_kernel, kernel


class Arcs(NamedTuple):
    """The arcs of a flow network, two for each edge: node i has the arcs start[i]..start[i + 1]."""

    start: IndexArray  # (N + 1,)
    target: IndexArray  # (2 E,) the node that an arc leads to
    reverse: IndexArray  # (2 E,) the arc of the same edge in the other direction


class Network(NamedTuple):
    """A graph prepared for many maximum flows."""

    graph: SurfaceGraph
    arcs: Arcs
    capacity: FloatArray  # (2 E,) of the arcs
    factor: LaplacianFactor

    @classmethod
    def of(cls, graph: SurfaceGraph) -> "Network":
        """The network whose capacities are the weights of a graph."""
        return network_of(graph, minimum_degree(graph.rows()))

    def minimum_cut(self, supply: FloatArray) -> BoolArray:
        """(N,) ``minimum_cut`` of the network."""
        return minimum_cut(self, supply)


@kernel
def network_of(graph: SurfaceGraph, order: IntArray) -> Network:
    """``Network.of`` for use in other kernels, with the order (N,) in which the nodes are eliminated."""
    rows = rows_of_edges(graph.edges, len(graph.volume))
    reverse = _reverse_arcs(rows.edge, len(graph.edges))
    arcs = Arcs(rows.start.astype(np.uint32), rows.neighbour.astype(np.uint32), reverse)
    return Network(graph, arcs, graph.weight[rows.edge], factor_of(rows, graph.weight, order))


@kernel
def minimum_cut(network: Network, supply: FloatArray) -> BoolArray:
    """(N,) True for the nodes of the largest set A of least cut(A) - supply(A), up to rounding.

    By the theorem of Ford and Fulkerson, A has the nodes at which supply is left over by a maximum flow from the
    positive supplies to the negative ones. The flow starts as the electrical flow, which satisfies all supplies but
    exceeds capacities. It is clipped to the capacities, which leaves an excess and a deficit at the ends of the
    edge, in most cases close to each other.

    Parameters
    ----------
    supply : (N,) with sum 0 over every component.
    """
    order, start, row, share, pivot = network.factor
    potential = substitute(order, start, row, share, pivot, supply)
    residual, excess = _electrical_flow(network.arcs, network.capacity, potential)
    distance = push(network.arcs, residual, excess)
    return distance == len(distance)


@inner_kernel
def _reverse_arcs(edge, edge_count):  # type: ignore[no-untyped-def]
    """(2 E,) the other arc of the same edge, from the edge of every arc."""
    first = np.full(edge_count, -1, dtype=np.int32)
    reverse = np.empty(len(edge), dtype=np.uint32)
    for arc in range(len(edge)):
        other = first[edge[arc]]
        if other < 0:
            first[edge[arc]] = arc
        else:
            reverse[arc] = other
            reverse[other] = arc
    return reverse


@inner_kernel
def _electrical_flow(arcs, capacity, potential):  # type: ignore[no-untyped-def]
    """The flow of a potential, clipped to the capacities: (2 E,) residual capacities and (N,) excess of the nodes."""
    start, target = arcs.start, arcs.target
    residual = np.empty(len(target))
    excess = np.zeros(len(potential))
    for i in range(len(potential)):
        for arc in range(start[i], start[i + 1]):
            flow = capacity[arc] * (potential[i] - potential[target[arc]])
            kept = min(max(flow, -capacity[arc]), capacity[arc])
            excess[i] += flow - kept
            residual[arc] = capacity[arc] - kept
    return residual, excess


@kernel
def push(arcs, residual, excess):  # type: ignore[no-untyped-def]
    """Move excess to deficits (negative excess) by push-relabel until the remaining excess cannot reach any.

    Nodes are processed first in, first out, and exact distances are measured now and then. Both arrays are changed. A
    push moves either the whole excess or the whole residual capacity, so that zeros are exact in floating point.

    Parameters
    ----------
    residual : (2 E,) residual capacities of the arcs.
    excess : (N,)

    Returns
    -------
    (N,) distances to the nearest deficit in the residual graph; N exactly if none can be reached.

    References
    ----------
    Goldberg and Tarjan, A new approach to the maximum-flow problem, J. ACM 35, 1988; Cherkassky and Goldberg, On
    implementing the push-relabel method for the maximum flow problem, Algorithmica 19, 1997.
    """
    start, target, reverse = arcs.start, arcs.target, arcs.reverse
    node_count = len(excess)
    distance = np.zeros(node_count, dtype=np.int32)
    queue = np.empty(node_count, dtype=np.uint32)
    queued = np.empty(node_count, dtype=np.bool_)
    current = np.empty(node_count, dtype=np.uint32)
    while True:
        measured = _measure_distances(arcs, residual, excess, distance, queue, False)
        head = 0
        waiting = 0
        for i in range(node_count):
            current[i] = start[i]
            queued[i] = excess[i] > 0 and distance[i] < node_count
            if queued[i]:
                queue[waiting] = i
                waiting += 1
        if waiting == 0:
            # Nodes without excess have lower bounds only.
            _measure_distances(arcs, residual, excess, distance, queue, True)
            return distance
        raised = 0
        enough = max(measured // 2, node_count // 10)  # set by hand: after as many, measuring again saves time
        while waiting > 0 and raised <= enough:
            i = queue[head]
            head = head + 1 if head + 1 < node_count else 0
            waiting -= 1
            queued[i] = False
            while excess[i] > 0 and distance[i] < node_count:
                if current[i] == start[i + 1]:
                    lowest = node_count
                    for arc in range(start[i], start[i + 1]):
                        if residual[arc] > 0:
                            lowest = min(lowest, distance[target[arc]] + 1)
                    distance[i] = lowest
                    current[i] = start[i]
                    raised += 1
                    continue
                arc = current[i]
                j = target[arc]
                if residual[arc] > 0 and distance[i] == distance[j] + 1:
                    amount = min(excess[i], residual[arc])
                    residual[arc] -= amount
                    residual[reverse[arc]] += amount
                    excess[i] -= amount
                    excess[j] += amount
                    if excess[j] > 0 and not queued[j]:
                        tail = head + waiting
                        queue[tail if tail < node_count else tail - node_count] = j
                        waiting += 1
                        queued[j] = True
                if excess[i] > 0:
                    current[i] += 1


@inner_kernel
def _measure_distances(arcs, residual, excess, distance, queue, everywhere):  # type: ignore[no-untyped-def]
    """Measure distances to the nearest deficit in the residual graph, breadth first; returns how many were measured.

    The search ends after the last node that has excess, unless ``everywhere``; farther nodes get a lower bound. A node
    from which no deficit can be reached keeps the distance N, because nothing is ever pushed to it.
    """
    start, target, reverse = arcs.start, arcs.target, arcs.reverse
    node_count = len(excess)
    end = 0
    sought = node_count if everywhere else 0
    for i in range(node_count):
        if distance[i] == node_count:
            continue
        distance[i] = -1
        if excess[i] < 0:
            distance[i] = 0
            queue[end] = i
            end += 1
        elif excess[i] > 0:
            sought += 1
    level = 0
    k = 0
    while k < end and sought > 0:
        j = queue[k]
        k += 1
        level = distance[j] + 1
        for arc in range(start[j], start[j + 1]):
            i = target[arc]
            if distance[i] < 0 and residual[reverse[arc]] > 0:
                distance[i] = level
                queue[end] = i
                end += 1
                if excess[i] > 0 and not everywhere:
                    sought -= 1
    farther = level if sought == 0 else node_count
    for i in range(node_count):
        if distance[i] < 0:
            distance[i] = farther
    return end
