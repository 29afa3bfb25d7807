"""Compiled kernels: shortest paths between the nodes of a graph, and connected components around some of them.

Shortest paths are those of Dijkstra, A note on two problems in connexion with graphs, 1959.
"""

import heapq

import numpy as np
from numba import njit


@njit(cache=True)
def distances_from_border(rows, step, region, limit):  # type: ignore[no-untyped-def]
    """(N,) the distance of the nodes of a region from its border; inf outside, beyond ``limit`` and without a border.

    Parameters
    ----------
    rows : the adjacency lists of the graph.
    step : (E,) length of every edge. The border lies in the middle of the edges that leave the region.
    region : (N,) True for the nodes of the region.
    """
    start, neighbour, edge = rows
    distance = np.full(len(region), np.inf)
    heap = [(0.0, np.int64(0))]
    heap.pop()
    for i in range(len(region)):
        if region[i]:
            for k in range(start[i], start[i + 1]):
                if not region[neighbour[k]]:
                    distance[i] = min(distance[i], 0.5 * step[edge[k]])
            if distance[i] <= limit:
                heapq.heappush(heap, (distance[i], np.int64(i)))
    _expand(rows, step, region, limit, heap, distance)
    for i in range(len(region)):
        if distance[i] > limit:
            distance[i] = np.inf
    return distance


@njit(cache=True)
def distances_from(rows, step, seeds, limit):  # type: ignore[no-untyped-def]
    """(N,) the distance from the nearest of some nodes; inf beyond ``limit``."""
    count = len(rows.start) - 1
    distance = np.full(count, np.inf)
    heap = [(0.0, np.int64(0))]
    heap.pop()
    for seed in seeds:
        distance[seed] = 0.0
        heapq.heappush(heap, (0.0, np.int64(seed)))
    _expand(rows, step, np.ones(count, dtype=np.bool_), limit, heap, distance)
    return distance


@njit(cache=True)
def _expand(rows, step, region, limit, heap, distance):  # type: ignore[no-untyped-def]
    """Carry distances on from the nodes of a heap, within a region and up to a limit."""
    start, neighbour, edge = rows
    while len(heap) > 0:
        reached, i = heapq.heappop(heap)
        if reached > distance[i]:
            continue
        for k in range(start[i], start[i + 1]):
            j = neighbour[k]
            further = reached + step[edge[k]]
            if region[j] and further < distance[j] and further <= limit:
                distance[j] = further
                heapq.heappush(heap, (further, np.int64(j)))


@njit(cache=True)
def nearest_seed(rows, step, region, seeds):  # type: ignore[no-untyped-def]
    """(N,) the index of the nearest seed, by a path within a region; -1 if there is none.

    Parameters
    ----------
    seeds : (K,) nodes of the region.
    """
    start, neighbour, edge = rows
    distance = np.full(len(region), np.inf)
    nearest = np.full(len(region), -1, dtype=np.int32)
    heap = [(0.0, np.int64(0))]
    heap.pop()
    for k in range(len(seeds)):
        distance[seeds[k]], nearest[seeds[k]] = 0.0, k
        heapq.heappush(heap, (0.0, np.int64(seeds[k])))
    while len(heap) > 0:
        reached, i = heapq.heappop(heap)
        if reached > distance[i]:
            continue
        for k in range(start[i], start[i + 1]):
            j = neighbour[k]
            further = reached + step[edge[k]]
            if region[j] and further < distance[j]:
                distance[j], nearest[j] = further, nearest[i]
                heapq.heappush(heap, (further, np.int64(j)))
    return nearest


@njit(cache=True)
def shortest_path(rows, step, region, origin, target):  # type: ignore[no-untyped-def]
    """The nodes of the shortest path within a region between two of its nodes; these two if there is none."""
    start, neighbour, edge = rows
    distance = np.full(len(region), np.inf)
    before = np.full(len(region), -1, dtype=np.int32)
    distance[origin] = 0.0
    heap = [(0.0, np.int64(origin))]
    while len(heap) > 0:
        reached, i = heapq.heappop(heap)
        if i == target:
            break
        if reached > distance[i]:
            continue
        for k in range(start[i], start[i + 1]):
            j = neighbour[k]
            further = reached + step[edge[k]]
            if region[j] and further < distance[j]:
                distance[j], before[j] = further, i
                heapq.heappush(heap, (further, np.int64(j)))
    path = [np.int64(target)]
    while path[-1] != origin and before[path[-1]] >= 0:
        path.append(np.int64(before[path[-1]]))
    if path[-1] != origin:
        path.append(np.int64(origin))
    return np.array(path[::-1], dtype=np.int32)


@njit(cache=True)
def marked_components(rows, inside, marked):  # type: ignore[no-untyped-def]
    """(N,) the connected components of a set that contain some of its nodes.

    Parameters
    ----------
    inside : (N,) True for the nodes of the set.
    marked : (K,) nodes of the set.
    """
    start, neighbour, _ = rows
    found = np.zeros(len(inside), dtype=np.bool_)
    queue = np.empty(len(inside), dtype=np.int32)
    end = 0
    for node in marked:
        if not found[node]:
            found[node] = True
            queue[end] = node
            end += 1
    k = 0
    while k < end:
        for entry in range(start[queue[k]], start[queue[k] + 1]):
            j = neighbour[entry]
            if inside[j] and not found[j]:
                found[j] = True
                queue[end] = j
                end += 1
        k += 1
    return found
