"""Compiled kernels for the band around one boundary: its faces, and its flow network."""

from typing import NamedTuple

import numpy as np

from segcore.arrays import FloatArray, IntArray
from segcore.graphs.inner_arcs import arcs_among
from segcore.graphs.max_flow import Arcs
from segcore.jit.decorators import inner_kernel, kernel


class Geometry(NamedTuple):
    """Positions on the surface."""

    edge_vertices: IntArray  # (E_mesh, 2) the ends of the edges of the mesh, the first E_mesh edges of the face graph
    vertices: FloatArray  # (V, 3)
    centres: FloatArray  # (F, 3) of the faces


class Band(NamedTuple):
    """The faces near a boundary."""

    faces: IntArray  # (M,)
    distance: FloatArray  # (M,) from the boundary


class BandNetwork(NamedTuple):
    """The flow network of the free faces of a band; its other faces are sources and sinks."""

    arcs: Arcs  # between the L free faces
    capacity: FloatArray  # (A,) of the arcs
    excess: FloatArray  # (L,) capacity from the lower side less that to the upper side


class _Queue(NamedTuple):
    """The faces found so far by a breadth-first search; the arrays have room for more."""

    faces: IntArray
    source: FloatArray  # (M, 3) the point from which the distance of a face is measured
    distance: FloatArray


@kernel
def grow_band(boundary, graph, geometry, place, bounds, width, local):  # type: ignore[no-untyped-def]
    """The faces of both sides of a split whose centres are within a distance from its boundary.

    Breadth-first from the boundary. Distances are measured from the middle of the boundary edge from which a face is
    reached, or from the centre of the first face if that edge is a link between components.

    Parameters
    ----------
    boundary : (B,) edges, among which are all that cross the split.
    width : the distance.
    local : (F,) work array, -1 before and after.
    """
    low, middle, high = bounds
    start, neighbour = graph.rows.start, graph.rows.neighbour
    pairs = graph.pairs
    edge_vertices, vertices, centres = geometry
    found = _Queue(np.empty(1024, dtype=np.int32), np.empty((1024, 3)), np.empty(1024))
    count = 0
    for e in boundary:
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
                if count == len(found.faces):
                    found = _doubled(found)
                local[f] = count
                found.faces[count], found.distance[count] = f, away
                found.source[count, 0], found.source[count, 1], found.source[count, 2] = x, y, z
                count += 1
    k = 0
    while k < count:
        f = found.faces[k]
        x, y, z = found.source[k, 0], found.source[k, 1], found.source[k, 2]
        for entry in range(start[f], start[f + 1]):
            g = neighbour[entry]
            if local[g] >= 0 or place[g] < low or place[g] >= high or (place[g] < middle) != (place[f] < middle):
                continue
            away = _distance(centres, g, x, y, z)
            if away <= width:
                if count == len(found.faces):
                    found = _doubled(found)
                local[g] = count
                found.faces[count], found.distance[count] = g, away
                found.source[count, 0], found.source[count, 1], found.source[count, 2] = x, y, z
                count += 1
        k += 1
    for k in range(count):
        local[found.faces[k]] = -1
    return Band(found.faces[:count].copy(), found.distance[:count].copy())


@inner_kernel
def _distance(centres, f, x, y, z):  # type: ignore[no-untyped-def]
    return np.sqrt((centres[f, 0] - x) ** 2 + (centres[f, 1] - y) ** 2 + (centres[f, 2] - z) ** 2)


@inner_kernel
def _doubled(found):  # type: ignore[no-untyped-def]
    """The queue with arrays of twice the size."""
    count = len(found.faces)
    larger = _Queue(np.empty(2 * count, dtype=np.int32), np.empty((2 * count, 3)), np.empty(2 * count))
    for k in range(count):  # assignments to slices take seconds to compile
        larger.faces[k], larger.distance[k] = found.faces[k], found.distance[k]
        for axis in range(3):
            larger.source[k, axis] = found.source[k, axis]
    return larger


@kernel
def free_faces(band, place, size, pinned):  # type: ignore[no-untyped-def]
    """The faces of a band that may change sides: all but the cores of its leaves.

    The core of a leaf that lies in the band as a whole has the faces that are farther from the boundary than half of
    the farthest. The core of a pinned leaf has all its faces.

    Parameters
    ----------
    size : (K,) number of faces of every leaf.
    pinned : (K,) True for pinned leaves.
    """
    faces, distance = band
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


@kernel
def band_network(free, graph, place, bounds, local, arc_of):  # type: ignore[no-untyped-def]
    """The flow network of the free faces: faces beyond them are sources on the lower side and sinks on the upper one.

    Parameters
    ----------
    free : (L,) faces.
    local : (F,) work array, -1 before and after.
    arc_of : (E,) work array, -1 before and after.
    """
    low, middle, high = bounds
    start, neighbour, edge_of = graph.rows
    weight = graph.weight
    for i in range(len(free)):
        local[free[i]] = i
    arcs, capacity = arcs_among(free, graph.rows, weight, local, arc_of)
    excess = np.zeros(len(free))
    for i in range(len(free)):
        for entry in range(start[free[i]], start[free[i] + 1]):
            g, e = neighbour[entry], edge_of[entry]
            if local[g] >= 0:
                continue
            if low <= place[g] < middle:
                excess[i] += weight[e]
            elif middle <= place[g] < high:
                excess[i] -= weight[e]
    for f in free:
        local[f] = -1
    return BandNetwork(arcs, capacity, excess)
