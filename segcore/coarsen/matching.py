"""Guarded heavy-edge coarsening: a few thousand clusters of faces that stand for a mesh of any size.

Pairs of neighbouring clusters are merged level by level. A pair is only merged while the mean affinity along its common
border is high, so that clusters end at concavities and the cuts of the coarse graph are cuts that the fine one has too.
"""

import numpy as np
from numba import njit

from segcore.arrays import FloatArray, IntArray, LongArray, group_sums
from segcore.graphs.surface_graph import SurfaceGraph

_GUARD = 0.5  # mean affinity along a border below which two clusters are not merged
_RELAXATION = 0.6  # factor on the guard whenever a level removes too few clusters
_STALLED = 0.10  # share of clusters removed below which the guard is relaxed
_LEAST_GUARD = 0.02
_GIVEN_UP = 0.03  # share of clusters removed below which coarsening ends once the guard is at its least
LARGEST_SHARE = 10.0  # largest cluster, in mean cluster volumes of the target
_NOISE = 0.3  # standard deviation of the logarithm of the random factor in the order of visits


def coarsen(
    graph: SurfaceGraph,
    target: int,
    rng: np.random.Generator,
    *,
    largest_share: float = LARGEST_SHARE,
) -> tuple[SurfaceGraph, IntArray]:
    """Merge the nodes of a graph into about ``target`` connected clusters.

    Parameters
    ----------
    target : number of clusters at which to stop; a graph that has no more nodes is returned as it is.
    largest_share : volume of the largest cluster, in mean volumes of the target.
    rng : breaks up the regular patterns that visiting nodes in the order of their volumes leaves on regular meshes.

    Returns
    -------
    The graph of the clusters (weights and lengths summed over parallel edges, volumes summed), and (N,) the cluster of
    every node.
    """
    cluster = np.arange(graph.node_count, dtype=np.int32)
    rows = graph.rows()
    start, neighbour = rows.start, rows.neighbour
    weight, border = graph.weight[rows.edge], graph.length[rows.edge]
    volume = graph.volume
    largest = largest_share * float(volume.sum()) / target
    guard = _GUARD
    while len(volume) > target:
        order = np.argsort(volume * rng.lognormal(sigma=_NOISE, size=len(volume)), kind="stable")
        merged, count = _match(order, start, neighbour, weight, border, volume, guard, largest, len(volume) - target)
        removed = 1.0 - count / len(volume)
        if removed < _STALLED and guard <= _LEAST_GUARD and removed < _GIVEN_UP:
            break
        if removed < _STALLED:
            guard = max(guard * _RELAXATION, _LEAST_GUARD)
        if count == len(volume):
            continue
        start, neighbour, weight, border = _contract(merged, count, start, neighbour, weight, border)
        volume = group_sums(merged, volume, count)
        cluster = merged[cluster]
    row = np.repeat(np.arange(len(volume), dtype=np.int32), np.diff(start))
    once = row < neighbour
    edges = np.stack([row[once], neighbour[once]], axis=1)
    return SurfaceGraph(edges, weight[once], volume, border[once]), cluster


@njit(cache=True)
def _match(
    order: LongArray,
    start: IntArray,
    neighbour: IntArray,
    weight: FloatArray,
    border: FloatArray,
    volume: FloatArray,
    guard: float,
    largest: float,
    most_merges: int,
) -> tuple[IntArray, int]:
    """Give every node the free neighbour with the largest w (w / l)**2 / sqrt(vol vol) that the guard allows.

    Returns
    -------
    (N,) the new cluster of every node, and how many there are.
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
        for p in range(start[i], start[i + 1]):
            j = neighbour[p]
            if mate[j] != -1 or weight[p] < guard * border[p] or volume[i] + volume[j] > largest:
                continue
            affinity = weight[p] / border[p] if border[p] > 0.0 else 1.0
            score = weight[p] * affinity * affinity / np.sqrt(volume[i] * volume[j])
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


@njit(cache=True)
def _contract(
    merged: IntArray,
    count: int,
    start: IntArray,
    neighbour: IntArray,
    weight: FloatArray,
    border: FloatArray,
) -> tuple[IntArray, IntArray, FloatArray, FloatArray]:
    """The adjacency of the merged nodes, parallel edges summed."""
    first = np.full(count, -1, np.int32)
    second = np.full(count, -1, np.int32)
    for i in range(len(merged)):
        if first[merged[i]] == -1:
            first[merged[i]] = i
        else:
            second[merged[i]] = i
    new_start = np.zeros(count + 1, np.int32)
    new_neighbour = np.empty(len(neighbour), np.int32)
    new_weight = np.empty(len(neighbour))
    new_border = np.empty(len(neighbour))
    place = np.full(count, -1, np.int64)
    used = 0
    for c in range(count):
        row = used
        for member in (first[c], second[c]):
            if member == -1:
                continue
            for p in range(start[member], start[member + 1]):
                d = merged[neighbour[p]]
                if d == c:
                    continue
                if place[d] < row:
                    place[d] = used
                    new_neighbour[used] = d
                    new_weight[used] = weight[p]
                    new_border[used] = border[p]
                    used += 1
                else:
                    new_weight[place[d]] += weight[p]
                    new_border[place[d]] += border[p]
        new_start[c + 1] = used
    return new_start, new_neighbour[:used].copy(), new_weight[:used].copy(), new_border[:used].copy()
