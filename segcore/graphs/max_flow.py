"""Maximum flows between sources and sinks that are spread over all nodes of a graph."""

from dataclasses import dataclass

import numpy as np
from numba import njit

from segcore.arrays import BoolArray, FloatArray
from segcore.graphs.laplacian import LaplacianFactor, factorise
from segcore.graphs.surface_graph import IndexArray, SurfaceGraph


@dataclass(frozen=True, slots=True, eq=False)
class Network:
    """A graph prepared for many maximum flows."""

    graph: SurfaceGraph
    start: IndexArray  # (N + 1,) the entries start[i]..start[i + 1] lead away from node i
    neighbour: IndexArray  # (2 E,)
    reverse: IndexArray  # (2 E,) the entry of the same edge in the other direction
    capacity: FloatArray  # (2 E,)
    factor: LaplacianFactor

    @classmethod
    def of(cls, graph: SurfaceGraph) -> "Network":
        rows = graph.rows()
        reverse = _reverse_entries(rows.edge, len(graph.edges))
        start, neighbour = rows.start.view(np.uint32), rows.neighbour.view(np.uint32)
        return cls(graph, start, neighbour, reverse, graph.weight[rows.edge], factorise(graph))

    def minimum_cut(self, supply: FloatArray) -> BoolArray:
        """(N,): the largest set A of least cut(A) - supply(A), up to rounding.

        By the theorem of Ford and Fulkerson it is where the supply stays that a maximum flow cannot carry to where the
        supply is negative. The flow starts as the electrical one, which carries everything but exceeds capacities: what
        is over is cut off and leaves an excess and a deficit at the ends of the edge, close to each other more often
        than not.

        Parameters
        ----------
        supply : (N,) with sum 0 over every component.
        """
        potential = self.factor.solve(supply)
        residual, excess = _electrical_flow(self.start, self.neighbour, self.capacity, potential)
        distance = push(self.start, self.neighbour, self.reverse, residual, excess)
        return distance == len(distance)


@njit(cache=True)
def _reverse_entries(edge, edge_count):  # type: ignore[no-untyped-def]
    first = np.full(edge_count, -1, dtype=np.int32)
    reverse = np.empty(len(edge), dtype=np.uint32)
    for entry in range(len(edge)):
        other = first[edge[entry]]
        if other < 0:
            first[edge[entry]] = entry
        else:
            reverse[entry] = other
            reverse[other] = entry
    return reverse


@njit(cache=True)
def _electrical_flow(start, neighbour, capacity, potential):  # type: ignore[no-untyped-def]
    """The flow of a potential, cut off at the capacities: what every entry can still take, and every node's excess."""
    residual = np.empty(len(neighbour))
    excess = np.zeros(len(potential))
    for i in range(len(potential)):
        for entry in range(start[i], start[i + 1]):
            flow = capacity[entry] * (potential[i] - potential[neighbour[entry]])
            kept = min(max(flow, -capacity[entry]), capacity[entry])
            excess[i] += flow - kept
            residual[entry] = capacity[entry] - kept
    return residual, excess


@njit(cache=True)
def push(start, neighbour, reverse, residual, excess):  # type: ignore[no-untyped-def]
    """Push-relabel: move excess to deficits (negative excess) until the rest of it cannot reach any.

    First in, first out, with exact distances now and then. Both arrays are changed. Amounts are moved whole or up to a
    capacity, so that zeros are exact in floating point.

    Returns a distance for every node, N exactly where no deficit can be reached.

    References
    ----------
    Goldberg and Tarjan, A new approach to the maximum-flow problem, J. ACM 35, 1988; Cherkassky and Goldberg, On
    implementing the push-relabel method for the maximum flow problem, Algorithmica 19, 1997.
    """
    node_count = len(excess)
    distance = np.zeros(node_count, dtype=np.int32)
    queue = np.empty(node_count, dtype=np.uint32)
    queued = np.empty(node_count, dtype=np.bool_)
    current = np.empty(node_count, dtype=np.uint32)
    while True:
        measured = _measure_distances(start, neighbour, reverse, residual, excess, distance, queue, False)
        head = 0
        waiting = 0
        for i in range(node_count):
            current[i] = start[i]
            queued[i] = excess[i] > 0 and distance[i] < node_count
            if queued[i]:
                queue[waiting] = i
                waiting += 1
        if waiting == 0:
            # Nodes without excess have been given lower bounds only.
            _measure_distances(start, neighbour, reverse, residual, excess, distance, queue, True)
            return distance
        raised = 0
        enough = max(measured // 2, node_count // 10)  # then measuring again costs less than it saves
        while waiting > 0 and raised <= enough:
            i = queue[head]
            head = head + 1 if head + 1 < node_count else 0
            waiting -= 1
            queued[i] = False
            while excess[i] > 0 and distance[i] < node_count:
                if current[i] == start[i + 1]:
                    lowest = node_count
                    for entry in range(start[i], start[i + 1]):
                        if residual[entry] > 0:
                            lowest = min(lowest, distance[neighbour[entry]] + 1)
                    distance[i] = lowest
                    current[i] = start[i]
                    raised += 1
                    continue
                entry = current[i]
                j = neighbour[entry]
                if residual[entry] > 0 and distance[i] == distance[j] + 1:
                    amount = min(excess[i], residual[entry])
                    residual[entry] -= amount
                    residual[reverse[entry]] += amount
                    excess[i] -= amount
                    excess[j] += amount
                    if excess[j] > 0 and not queued[j]:
                        tail = head + waiting
                        queue[tail if tail < node_count else tail - node_count] = j
                        waiting += 1
                        queued[j] = True
                if excess[i] > 0:
                    current[i] += 1


@njit(cache=True)
def _measure_distances(start, neighbour, reverse, residual, excess, distance, queue, everywhere):  # type: ignore[no-untyped-def]
    """Distances to the nearest deficit in the residual graph, breadth first, everywhere or as far as there is excess.

    Farther nodes get a lower bound. A node from which no deficit can be reached has distance N from then on: nothing is
    ever pushed to it. Returns the number of nodes measured.
    """
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
        for entry in range(start[j], start[j + 1]):
            i = neighbour[entry]
            if distance[i] < 0 and residual[reverse[entry]] > 0:
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
