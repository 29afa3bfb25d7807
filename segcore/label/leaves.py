"""Compiled kernels that keep the places of faces while faces change sides. Arrays in, arrays out.

A *place* is the number of a leaf; the leaves of a node have consecutive ones. ``bounds`` are those of a split: the
lower side has the places low..middle - 1, the upper one middle..high - 1. Scratch arrays are left as they were.
"""

import numpy as np
from numba import njit


@njit(cache=True)
def split_between(one, other, split_at):  # type: ignore[no-untyped-def]
    """The split that parts two different places: the first one at any gap between them."""
    low, high = min(one, other), max(one, other)
    split = split_at[low + 1]
    for gap in range(low + 2, high + 1):
        split = min(split, split_at[gap])
    return split


@njit(cache=True)
def crossing_edges(edges, place, split_at):  # type: ignore[no-untyped-def]
    """The edges between different places, and the split that each of them crosses."""
    count = 0
    for e in range(len(edges)):
        if place[edges[e, 0]] != place[edges[e, 1]]:
            count += 1
    crossing = np.empty(count, dtype=np.int32)
    split = np.empty(count, dtype=np.int32)
    count = 0
    for e in range(len(edges)):
        one, other = place[edges[e, 0]], place[edges[e, 1]]
        if one != other:
            crossing[count] = e
            split[count] = split_between(one, other, split_at)
            count += 1
    return crossing, split


@njit(cache=True)
def changed_places(free, lower, place, bounds, rows, weight, local):  # type: ignore[no-untyped-def]
    """The faces that change sides, and the place that each gets: that of a neighbour on its new side.

    Parameters
    ----------
    lower : (M,) True for the free faces that belong to the lower side from now on.
    """
    low, middle, high = bounds
    start, neighbour, edge_of = rows
    moved = np.empty(len(free), dtype=np.int32)
    count = 0
    for i in range(len(free)):
        if lower[i] != (place[free[i]] < middle):
            moved[count] = free[i]
            local[free[i]] = count
            count += 1
    new_place = np.full(count, -1, dtype=np.int32)
    queue = np.empty(count, dtype=np.int32)
    tail = 0
    for k in range(count):
        f = moved[k]
        best = 0.0
        for entry in range(start[f], start[f + 1]):
            g = neighbour[entry]
            opposite = low <= place[g] < high and (place[g] < middle) != (place[f] < middle)
            if opposite and local[g] < 0 and weight[edge_of[entry]] > best:
                best = weight[edge_of[entry]]
                new_place[k] = place[g]
        if best > 0.0:
            queue[tail] = k
            tail += 1
    head = 0
    while head < tail:
        k = queue[head]
        head += 1
        f = moved[k]
        for entry in range(start[f], start[f + 1]):
            j = local[neighbour[entry]]
            if j >= 0 and new_place[j] < 0 and (place[moved[j]] < middle) == (place[f] < middle):
                new_place[j] = new_place[k]
                queue[tail] = j
                tail += 1
    for k in range(count):
        local[moved[k]] = -1
    # Faces that nothing reaches stay where they are.
    reached = new_place[:count] >= 0
    return moved[:count][reached], new_place[reached]


@njit(cache=True)
def move(faces, new_place, place, size, crossings, split_at, rows):  # type: ignore[no-untyped-def]
    """Give faces other places, and keep count of the faces of every leaf and of the edges that cross every split."""
    start, neighbour, _edge_of = rows
    for k in range(len(faces)):
        f = faces[k]
        for entry in range(start[f], start[f + 1]):
            other = place[neighbour[entry]]
            if other != place[f]:
                crossings[split_between(other, place[f], split_at)] -= 1
            if other != new_place[k]:
                crossings[split_between(other, new_place[k], split_at)] += 1
        size[place[f]] -= 1
        size[new_place[k]] += 1
        place[f] = new_place[k]


@njit(cache=True)
def broken_leaves(faces, old_place, place, size, least, rows, visited):  # type: ignore[no-untyped-def]
    """(K,) True for the leaves that have lost some of the faces and have too few now, or are in several pieces."""
    start, neighbour, _edge_of = rows
    broken = np.zeros(len(size), dtype=np.bool_)
    checked = np.zeros(len(size), dtype=np.bool_)
    queue = np.empty(1024, dtype=np.int32)
    for k in range(len(faces)):
        leaf = old_place[k]
        if checked[leaf]:
            continue
        seed = -1
        for entry in range(start[faces[k]], start[faces[k] + 1]):
            if place[neighbour[entry]] == leaf:
                seed = neighbour[entry]
        if size[leaf] < least[leaf]:
            broken[leaf] = checked[leaf] = True
        if seed < 0 or checked[leaf]:
            continue
        checked[leaf] = True
        if len(queue) < size[leaf]:
            queue = np.empty(size[leaf], dtype=np.int32)
        queue[0] = seed
        visited[seed] = True
        head, tail = 0, 1
        while head < tail:
            f = queue[head]
            head += 1
            for entry in range(start[f], start[f + 1]):
                g = neighbour[entry]
                if place[g] == leaf and not visited[g]:
                    visited[g] = True
                    queue[tail] = g
                    tail += 1
        broken[leaf] = tail < size[leaf]
        for q in range(tail):
            visited[queue[q]] = False
    return broken


@njit(cache=True)
def edges_around(faces, rows):  # type: ignore[no-untyped-def]
    """The edges of faces, with repetitions."""
    start, _neighbour, edge_of = rows
    count = 0
    for f in faces:
        count += start[f + 1] - start[f]
    edges = np.empty(count, dtype=np.int32)
    count = 0
    for f in faces:
        for entry in range(start[f], start[f + 1]):
            edges[count] = edge_of[entry]
            count += 1
    return edges
