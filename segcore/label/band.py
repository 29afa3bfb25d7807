"""Compiled kernels for the band around one boundary: which faces it has, and its network of flows.

A *place* is the number of a leaf; the leaves of a node have consecutive ones. ``bounds`` are those of a split: the
lower side has the places low..middle - 1, the upper one middle..high - 1. Scratch arrays are left as they were.
"""

import numpy as np
from numba import njit


@njit(cache=True)
def grow_band(edges, pairs, place, bounds, rows, edge_vertices, vertices, centres, width, local):  # type: ignore[no-untyped-def]
    """The faces of both sides whose centres are within a width of the boundary, and their distances from it.

    Breadth-first from the boundary; the distance is to the middle of the boundary edge from which a face is reached, or
    to the centre of the first face where that edge is none of the mesh.
    """
    low, middle, high = bounds
    start, neighbour, _edge_of = rows
    faces = np.empty(1024, dtype=np.int32)
    source = np.empty((1024, 3))
    distance = np.empty(1024)
    count = 0
    for e in edges:
        one, other = place[pairs[e, 0]], place[pairs[e, 1]]
        if min(one, other) < low or max(one, other) >= high or (one < middle) == (other < middle):
            continue
        for end in range(2):
            f = pairs[e, end]
            if local[f] >= 0:
                continue
            x, y, z = centres[f, 0], centres[f, 1], centres[f, 2]
            if e < len(edge_vertices):
                a, b = edge_vertices[e, 0], edge_vertices[e, 1]
                x = 0.5 * (vertices[a, 0] + vertices[b, 0])
                y = 0.5 * (vertices[a, 1] + vertices[b, 1])
                z = 0.5 * (vertices[a, 2] + vertices[b, 2])
            away = _distance(centres, f, x, y, z)
            if away <= width:
                if count == len(faces):
                    faces, source, distance = _doubled(faces, source, distance)
                local[f] = count
                faces[count], distance[count] = f, away
                source[count, 0], source[count, 1], source[count, 2] = x, y, z
                count += 1
    k = 0
    while k < count:
        f = faces[k]
        x, y, z = source[k, 0], source[k, 1], source[k, 2]
        for entry in range(start[f], start[f + 1]):
            g = neighbour[entry]
            if local[g] >= 0 or place[g] < low or place[g] >= high or (place[g] < middle) != (place[f] < middle):
                continue
            away = _distance(centres, g, x, y, z)
            if away <= width:
                if count == len(faces):
                    faces, source, distance = _doubled(faces, source, distance)
                local[g] = count
                faces[count], distance[count] = g, away
                source[count, 0], source[count, 1], source[count, 2] = x, y, z
                count += 1
        k += 1
    for k in range(count):
        local[faces[k]] = -1
    return faces[:count].copy(), distance[:count].copy()


@njit(cache=True)
def _distance(centres, f, x, y, z):  # type: ignore[no-untyped-def]
    return np.sqrt((centres[f, 0] - x) ** 2 + (centres[f, 1] - y) ** 2 + (centres[f, 2] - z) ** 2)


@njit(cache=True)
def _doubled(faces, source, distance):  # type: ignore[no-untyped-def]
    count = len(faces)
    more_faces = np.empty(2 * count, dtype=np.int32)
    more_source = np.empty((2 * count, 3))
    more_distance = np.empty(2 * count)
    more_faces[:count], more_source[:count], more_distance[:count] = faces, source, distance
    return more_faces, more_source, more_distance


@njit(cache=True)
def free_faces(faces, distance, place, size, pinned):  # type: ignore[no-untyped-def]
    """The faces of a band without the cores of its leaves.

    Where a leaf lies in the band as a whole, its core are the faces that are farther from the boundary than half of the
    farthest. Where it is pinned, its core is all of it.
    """
    within = np.zeros(len(size), dtype=np.int32)
    deepest = np.zeros(len(size))
    for k in range(len(faces)):
        leaf = place[faces[k]]
        within[leaf] += 1
        deepest[leaf] = max(deepest[leaf], distance[k])
    free = np.empty(len(faces), dtype=np.int32)
    count = 0
    for k in range(len(faces)):
        leaf = place[faces[k]]
        whole = within[leaf] == size[leaf]
        if not pinned[leaf] and not (whole and distance[k] >= 0.5 * deepest[leaf]):
            free[count] = faces[k]
            count += 1
    return free[:count].copy()


@njit(cache=True)
def band_network(free, place, bounds, rows, weight, local, entry_of):  # type: ignore[no-untyped-def]
    """The free faces as a network: rows, entries in the other direction, capacities, and the excess of every face.

    What lies beyond the free faces is a source on the lower side and a sink on the upper one.
    """
    low, middle, high = bounds
    start, neighbour, edge_of = rows
    for i in range(len(free)):
        local[free[i]] = i
    entries = 0
    for f in free:
        for entry in range(start[f], start[f + 1]):
            if local[neighbour[entry]] >= 0:
                entries += 1
    begin = np.empty(len(free) + 1, dtype=np.uint32)
    target = np.empty(entries, dtype=np.uint32)
    reverse = np.empty(entries, dtype=np.uint32)
    capacity = np.empty(entries)
    excess = np.zeros(len(free))
    count = 0
    for i in range(len(free)):
        f = free[i]
        begin[i] = count
        for entry in range(start[f], start[f + 1]):
            g, e = neighbour[entry], edge_of[entry]
            if local[g] >= 0:
                target[count] = local[g]
                capacity[count] = weight[e]
                if entry_of[e] < 0:
                    entry_of[e] = count
                else:
                    reverse[count] = entry_of[e]
                    reverse[entry_of[e]] = count
                    entry_of[e] = -1
                count += 1
            elif low <= place[g] < middle:
                excess[i] += weight[e]
            elif middle <= place[g] < high:
                excess[i] -= weight[e]
    begin[len(free)] = count
    for f in free:
        local[f] = -1
    return begin, target, reverse, capacity, excess
