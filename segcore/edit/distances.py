"""Compiled kernels: shortest paths between the nodes of a graph, and connected components around some of them.

Shortest paths are those of Dijkstra, A note on two problems in connexion with graphs, 1959.
"""

import heapq

import numpy as np

from segcore.jit.decorators import inner_kernel, kernel

_NONE = -1  # in place of a node


@kernel
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
    heap = _empty_heap()
    for i in range(len(region)):
        if region[i]:
            nearest = np.inf
            for k in range(start[i], start[i + 1]):
                if not region[neighbour[k]]:
                    nearest = min(nearest, 0.5 * step[edge[k]])
            if nearest < np.inf and nearest <= limit:
                distance[i] = nearest
                heapq.heappush(heap, (nearest, np.int64(i)))
    _search(rows, step, region, limit, heap, distance, _NONE)
    return distance


@kernel
def distances_from(rows, step, seeds, limit):  # type: ignore[no-untyped-def]
    """(N,) the distance from the nearest of some nodes; inf beyond ``limit``."""
    count = len(rows.start) - 1
    distance = np.full(count, np.inf)
    _search(rows, step, np.ones(count, dtype=np.bool_), limit, _heap_of(seeds, distance), distance, _NONE)
    return distance


@kernel
def nearest_seed(rows, step, region, seeds):  # type: ignore[no-untyped-def]
    """(N,) the index of the nearest seed, by a path within a region; -1 if there is none.

    Parameters
    ----------
    seeds : (K,) nodes of the region.
    """
    distance = np.full(len(region), np.inf)
    before = _search(rows, step, region, np.inf, _heap_of(seeds, distance), distance, _NONE)
    nearest = np.full(len(region), -1, dtype=np.int32)
    for k in range(len(seeds)):
        nearest[seeds[k]] = k
    path = np.empty(len(region), dtype=np.int32)
    for i in range(len(region)):
        length, node = 0, i
        while nearest[node] < 0 and before[node] != _NONE:
            path[length] = node
            length, node = length + 1, before[node]
        for k in range(length):
            nearest[path[k]] = nearest[node]
    return nearest


@kernel
def shortest_path(rows, step, region, origin, target):  # type: ignore[no-untyped-def]
    """The nodes of the shortest path within a region between two of its nodes; these two if there is none."""
    distance = np.full(len(region), np.inf)
    before = _search(rows, step, region, np.inf, _heap_of(np.array([origin]), distance), distance, target)
    path = [np.int64(target)]
    while path[-1] != origin and before[path[-1]] != _NONE:
        path.append(np.int64(before[path[-1]]))
    if path[-1] != origin:
        path.append(np.int64(origin))
    return np.array(path[::-1], dtype=np.int32)


@inner_kernel
def _empty_heap():  # type: ignore[no-untyped-def]
    heap = [(0.0, np.int64(0))]  # numba takes the type of a list from its first entry
    heap.pop()
    return heap


@inner_kernel
def _heap_of(seeds, distance):  # type: ignore[no-untyped-def]
    """A heap of seeds, whose distances become 0."""
    heap = _empty_heap()
    for seed in seeds:
        distance[seed] = 0.0
        heapq.heappush(heap, (0.0, np.int64(seed)))
    return heap


@inner_kernel
def _search(rows, step, region, limit, heap, distance, target):  # type: ignore[no-untyped-def]
    """Carry distances on from the nodes of a heap, within a region, up to a limit and until a target is reached.

    Returns
    -------
    (N,) the node before each on its shortest path; -1 if there is none.
    """
    start, neighbour, edge = rows
    before = np.full(len(region), _NONE, dtype=np.int32)
    while len(heap) > 0:
        reached, i = heapq.heappop(heap)
        if i == target:
            break
        if reached > distance[i]:
            continue
        for k in range(start[i], start[i + 1]):
            j = neighbour[k]
            further = reached + step[edge[k]]
            if region[j] and further < distance[j] and further <= limit:
                distance[j], before[j] = further, i
                heapq.heappush(heap, (further, np.int64(j)))
    return before


@kernel
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
