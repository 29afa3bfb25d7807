"""Guarded heavy-edge coarsening: a few thousand clusters of faces in place of a mesh of any size.

Pairs of neighbouring clusters are merged level by level. A pair is only merged while the mean affinity along its common
border is high, so that clusters end at concavities and the cuts of the coarse graph are also cuts of the fine one.
"""

from typing import NamedTuple

import numpy as np

from segcore.array_kernels import ascending
from segcore.arrays import FloatArray, IntArray, group_sums
from segcore.coarsen.grains import merged_grains
from segcore.graphs.surface_graph import SurfaceGraph
from segcore.jit.decorators import kernel

# The sources of these numbers are in docs/algorithm.md, "Constants" of section 3.
_GUARD = 0.5  # mean affinity along a border below which two clusters are not merged
_RELAXATION = 0.6  # factor on the guard whenever a level removes too few clusters
_STALLED = 0.10  # share of clusters removed below which the guard is relaxed
_LEAST_GUARD = 0.02
_GIVEN_UP = 0.03  # share of clusters removed below which coarsening ends once the guard is at its least
LARGEST_SHARE = 10.0  # largest cluster, in mean cluster volumes of the target
_NOISE = 0.3  # standard deviation of the logarithm of the random factor in the order of visits


class _Adjacency(NamedTuple):
    """A weighted graph by rows: node i has the entries start[i]..start[i + 1] - 1 of the other arrays."""

    start: IntArray  # (N + 1,)
    neighbour: IntArray  # (2 E,)
    weight: FloatArray  # (2 E,)
    border: FloatArray  # (2 E,) length of the common border


def coarsen(
    graph: SurfaceGraph,
    target: int,
    rng: np.random.Generator,
    *,
    largest_share: float = LARGEST_SHARE,
    grain: IntArray | None = None,
) -> tuple[SurfaceGraph, IntArray]:
    """Merge the nodes of a graph into about ``target`` connected clusters. O(E log E).

    Parameters
    ----------
    target : number of clusters at which to stop. A graph without more nodes is returned as it is.
    largest_share : volume of the largest cluster, in mean volumes of the target.
    grain : (N,) the groups of nodes to begin with; None to begin with the nodes. See ``segcore.coarsen.grains``.
    rng : randomises the order of visits; visiting nodes by volume alone leaves regular patterns on regular meshes.

    Returns
    -------
    The graph of the clusters (weights and lengths summed over parallel edges, volumes summed), and (N,) the cluster of
    every node.
    """
    if grain is None or graph.node_count <= target:
        cluster = np.arange(graph.node_count, dtype=np.int32)
    else:
        graph, cluster = merged_grains(graph, grain)
    rows = graph.rows()
    adjacency = _Adjacency(rows.start, rows.neighbour, graph.weight[rows.edge], graph.length[rows.edge])
    volume = graph.volume
    largest = largest_share * float(volume.sum()) / target
    guard = _GUARD
    while len(volume) > target:
        order = ascending(volume * rng.lognormal(sigma=_NOISE, size=len(volume)))
        merged, count = _match(order, adjacency, volume, guard, largest, len(volume) - target)
        removed = 1.0 - count / len(volume)
        if removed < _STALLED and guard <= _LEAST_GUARD and removed < _GIVEN_UP:
            break
        if removed < _STALLED:
            guard = max(guard * _RELAXATION, _LEAST_GUARD)
        if count == len(volume):
            continue
        adjacency = _contract(merged, count, adjacency)
        volume = group_sums(merged, volume, count)
        cluster = merged[cluster]
    row = np.repeat(np.arange(len(volume), dtype=np.int32), np.diff(adjacency.start))
    once = row < adjacency.neighbour
    edges = np.stack([row[once], adjacency.neighbour[once]], axis=1)
    return SurfaceGraph(edges, adjacency.weight[once], volume, adjacency.border[once]), cluster


@kernel
def _match(
    order: IntArray, graph: _Adjacency, volume: FloatArray, guard: float, largest: float, most_merges: int
) -> tuple[IntArray, int]:
    """Merge every node with the free neighbour with the largest w (w / l)**2 / sqrt(vol vol) that the guard allows.

    Parameters
    ----------
    order : (N,) the nodes in the order of their visits.
    largest : volume of a cluster, at most.

    Returns
    -------
    (N,) the new cluster of every node, and the number of clusters.
    """
    node_count = len(volume)
    mate = np.full(node_count, -1, np.int32)
    merges = 0
    for i in order:
        if merges == most_merges:
            break
        if mate[i] != -1:
            continue
        best, best_score = -1, 0.0
        for p in range(graph.start[i], graph.start[i + 1]):
            j, w, border = graph.neighbour[p], graph.weight[p], graph.border[p]
            if mate[j] != -1 or w < guard * border or volume[i] + volume[j] > largest:
                continue
            affinity = w / border if border > 0.0 else 1.0
            score = w * affinity * affinity / np.sqrt(volume[i] * volume[j])
            if score > best_score or (score == best_score and (best == -1 or j < best)):
                best, best_score = j, score
        if best != -1:
            mate[i], mate[best] = best, i
            merges += 1
    merged = np.full(node_count, -1, np.int32)
    count = 0
    for i in range(node_count):
        if merged[i] == -1:
            merged[i] = count
            if mate[i] != -1:
                merged[mate[i]] = count
            count += 1
    return merged, count


@kernel
def _contract(merged: IntArray, count: int, graph: _Adjacency) -> _Adjacency:
    """The graph of the merged nodes, at most two in each; parallel edges are summed.

    Parameters
    ----------
    merged : (N,) the new node 0..count - 1 of every node.
    """
    first = np.full(count, -1, np.int32)
    second = np.full(count, -1, np.int32)
    for i in range(len(merged)):
        if first[merged[i]] == -1:
            first[merged[i]] = i
        else:
            second[merged[i]] = i
    start = np.zeros(count + 1, np.int32)
    neighbour = np.empty(len(graph.neighbour), np.int32)
    weight = np.empty(len(graph.neighbour))
    border = np.empty(len(graph.neighbour))
    place = np.full(count, -1, np.int64)
    used = 0
    for c in range(count):
        row = used
        for member in (first[c], second[c]):
            if member == -1:
                continue
            for p in range(graph.start[member], graph.start[member + 1]):
                d = merged[graph.neighbour[p]]
                if d == c:
                    continue
                if place[d] < row:
                    place[d] = used
                    neighbour[used] = d
                    weight[used] = graph.weight[p]
                    border[used] = graph.border[p]
                    used += 1
                else:
                    weight[place[d]] += graph.weight[p]
                    border[place[d]] += graph.border[p]
        start[c + 1] = used
    return _Adjacency(start, neighbour[:used].copy(), weight[:used].copy(), border[:used].copy())
