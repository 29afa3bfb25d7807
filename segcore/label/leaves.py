"""Compiled kernels for the leaves of a tree over faces, while faces change sides.

A *place* is the number of a leaf; the leaves of every node of the tree have consecutive places.
"""

from typing import NamedTuple

import numpy as np

from segcore.arrays import FloatArray, IntArray, LongArray
from segcore.graphs.surface_graph import Rows
from segcore.jit.decorators import kernel


class FaceGraph(NamedTuple):
    """The dual graph of the faces of a mesh, with the links between its components."""

    pairs: IntArray  # (E, 2) the two faces at every edge; the edges of the mesh come first, then the links
    weight: FloatArray  # (E,) cost of a boundary along the edge, > 0
    rows: Rows


class Bounds(NamedTuple):
    """The places of the two sides of a split: low..middle - 1 and middle..high - 1."""

    low: int
    middle: int
    high: int


class Placement(NamedTuple):
    """The place of every face, and the counts that depend on it; changed in place."""

    place: IntArray  # (F,)
    size: LongArray  # (K,) number of faces at every place
    crossings: LongArray  # (S,) number of edges that cross every split
    split_at: IntArray  # (K,) the split between the leaves at the places i - 1 and i; constant


@kernel
def split_between(one, other, split_at):  # type: ignore[no-untyped-def]
    """The split between two different places: the first one in the tree of those at the gaps between them."""
    low, high = min(one, other), max(one, other)
    split = split_at[low + 1]
    for gap in range(low + 2, high + 1):
        split = min(split, split_at[gap])
    return split


@kernel
def crossing_edges(pairs, place, split_at):  # type: ignore[no-untyped-def]
    """(M,) edges between different places, and (M,) the split that each of them crosses."""
    count = 0
    for e in range(len(pairs)):
        if place[pairs[e, 0]] != place[pairs[e, 1]]:
            count += 1
    crossing = np.empty(count, dtype=np.int32)
    split = np.empty(count, dtype=np.int32)
    count = 0
    for e in range(len(pairs)):
        one, other = place[pairs[e, 0]], place[pairs[e, 1]]
        if one != other:
            crossing[count] = e
            split[count] = split_between(one, other, split_at)
            count += 1
    return crossing, split


@kernel
def changed_places(free, lower, graph, place, bounds, local):  # type: ignore[no-untyped-def]
    """(M,) faces that change sides, and (M,) the new place of each: that of a neighbour on its new side.

    Faces that no such neighbour can reach stay where they are.

    Parameters
    ----------
    free : (L,) faces that may change sides.
    lower : (L,) True for the free faces that belong to the lower side from now on.
    local : (F,) work array, -1 before and after.
    """
    low, middle, high = bounds
    start, neighbour, edge_of = graph.rows
    weight = graph.weight
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
    reached = new_place[:count] >= 0
    return moved[:count][reached], new_place[reached]


@kernel
def move(faces, new_place, placement, rows):  # type: ignore[no-untyped-def]
    """Give faces other places, and update the counts of faces and of crossing edges."""
    start, neighbour = rows.start, rows.neighbour
    place, size, crossings, split_at = placement
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


@kernel
def broken_leaves(faces, old_place, placement, least, rows, visited):  # type: ignore[no-untyped-def]
    """(K,) True for the leaves that have lost faces and are now too small or not connected.

    Parameters
    ----------
    faces, old_place : (M,) the faces that have moved, and their places before.
    least : (K,) the least number of faces of every leaf.
    visited : (F,) work array, False before and after.
    """
    start, neighbour = rows.start, rows.neighbour
    place, size = placement.place, placement.size
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


@kernel
def edges_around(faces, rows):  # type: ignore[no-untyped-def]
    """The edges of some faces, with repetitions."""
    start, edge_of = rows.start, rows.edge
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
