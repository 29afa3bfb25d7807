"""Grains: small connected groups of faces of a fine mesh, from which patches and clusters are made alike.

A mesh is coarsened twice, to patches and, with the affinity that is measured on these, to clusters. The first merges of
both are those of faces that lie beside each other on a smooth surface, and they are most of the work.
"""

import numpy as np

from segcore.arrays import IntArray, group_sums
from segcore.graphs.surface_graph import SurfaceGraph, components_inside, edges_between
from segcore.jit.decorators import kernel

# Set by hand. There are about 8 grains or more in each of 5,000 clusters, whose outlines are drawn again afterwards.
MANY = 1 << 17  # nodes from which on there are grains
_COUNT = 40_000  # grains, at least, if each has as many nodes as it may have
_MOST = 32  # nodes of a grain
_LARGEST = 1.5  # volume of a grain of several nodes, in mean volumes of as many nodes as it may have
_GUARD = 0.5  # least affinity between the nodes of a grain, as in coarsen/matching.py


def grains_of(graph: SurfaceGraph) -> IntArray | None:
    """(N,) the grain of every node, None for a graph of fewer than 131,072 nodes, see ``grown_grains``."""
    return None if graph.node_count < MANY else grown_grains(graph)


def grown_grains(graph: SurfaceGraph) -> IntArray:
    """(N,) the grain 0, 1, ... of every node of a graph. O(N + E).

    Grains are grown breadth-first, in the order of the nodes, over edges whose affinity is at least 0.5. They have one
    node for every 40,000 nodes of the graph, but 32 at most.
    """
    most = min(_MOST, max(2, graph.node_count // _COUNT))
    largest = _LARGEST * most * float(graph.volume.mean())
    rows = graph.rows()
    return _grown(rows.start, rows.neighbour, rows.edge, graph.weight, graph.length, graph.volume, most, largest)


def merged_grains(graph: SurfaceGraph, grain: IntArray) -> tuple[SurfaceGraph, IntArray]:
    """The graph of the grains of a graph, or of what is left of them in it, and (N,) the new grain of every node.

    Parameters
    ----------
    grain : (N,) of every node. A grain that edges of this graph with an affinity of at least 0.5 do not connect is
        divided.
    """
    is_strong = graph.weight >= _GUARD * graph.length
    grain = components_inside(graph.edges[is_strong], grain)
    edge = edges_between(graph.edges, grain)
    volume = group_sums(grain, graph.volume)
    pairs = grain[graph.edges[edge]]
    return SurfaceGraph.with_sums(pairs, graph.weight[edge], volume, graph.length[edge]), grain


@kernel
def _grown(start, neighbour, edge, weight, length, volume, most, largest):  # type: ignore[no-untyped-def]
    grain = np.full(len(volume), -1, np.int32)
    members = np.empty(most, np.int32)
    grains = 0
    for seed in range(len(volume)):
        if grain[seed] >= 0:
            continue
        grain[seed] = grains
        members[0] = seed
        head, tail, total = 0, 1, volume[seed]
        while head < tail and tail < most:
            i = members[head]
            head += 1
            for p in range(start[i], start[i + 1]):
                j, e = neighbour[p], edge[p]
                if grain[j] < 0 and tail < most and weight[e] >= _GUARD * length[e] and total + volume[j] <= largest:
                    grain[j] = grains
                    members[tail] = j
                    total += volume[j]
                    tail += 1
        grains += 1
    return grain
