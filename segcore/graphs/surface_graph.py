"""Weighted graphs whose nodes have volumes, their adjacency lists and their connected components."""

from dataclasses import dataclass
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from segcore.array_kernels import distinct_pairs
from segcore.arrays import BoolArray, FloatArray, IntArray, LongArray, group_sums, pair_keys
from segcore.jit.decorators import inner_kernel, kernel

IndexArray: TypeAlias = NDArray[np.uint32]  # unsigned: compiled loops then need no test for negative indices


class Rows(NamedTuple):
    """The rows of an adjacency matrix: node i has the entries start[i]..start[i + 1] of the two other arrays."""

    start: IntArray  # (N + 1,)
    neighbour: IntArray  # (2 E,)
    edge: IntArray  # (2 E,) the edge of the graph between the node and this neighbour


class SurfaceGraph(NamedTuple):
    """An undirected graph without loops, each edge listed once. Kernels take it whole.

    The nodes are vertices of a mesh, its faces, or clusters of faces; the solvers do not depend on which.
    """

    edges: IntArray  # (E, 2) node pairs, edges[:, 0] < edges[:, 1]
    weight: FloatArray  # (E,) length times affinity, > 0
    volume: FloatArray  # (N,) node volume, > 0
    length: FloatArray  # (E,) length of the common border of the two nodes

    @classmethod
    def with_sums(
        cls, pairs: NDArray[np.integer], weight: FloatArray, volume: FloatArray, length: FloatArray
    ) -> "SurfaceGraph":
        """Return the graph of edges that may be parallel: their weights and lengths are summed.

        Parameters
        ----------
        pairs : (M, 2) node pairs, in any order.
        weight, length : (M,)
        """
        edges, which = distinct_pairs(pairs)
        count = len(edges)
        return cls(edges, group_sums(which, weight, count), volume, group_sums(which, length, count))

    @property
    def node_count(self) -> int:
        return len(self.volume)

    @property
    def total_volume(self) -> float:
        return float(self.volume.sum())

    def rows(self) -> Rows:
        """Return the neighbours and the edges of every node, in the order of the edge list. O(N + E)."""
        return rows_of(self.edges, self.node_count)

    def adjacency(self) -> "csr_matrix[Any]":
        """Return the symmetric (N, N) matrix W of the weights, its diagonal zero."""
        rows = self.rows()
        shape = (self.node_count, self.node_count)
        return csr_matrix((self.weight[rows.edge], rows.neighbour, rows.start), shape=shape)

    def degrees(self) -> FloatArray:
        """(N,) weighted degree of every node, the sum of its row of W."""
        return weighted_degrees(self.edges, self.weight, self.node_count)

    def subgraph(self, nodes: IntArray) -> "SurfaceGraph":
        """Return the graph of the edges inside a set of nodes; the nodes keep their volumes. O(N + E).

        Parameters
        ----------
        nodes : (M,) distinct indices; node i of the result is node nodes[i] of this graph.
        """
        edges, kept = induced_edges(self.edges, nodes, self.node_count)
        return SurfaceGraph(edges, self.weight[kept], self.volume[nodes], self.length[kept])

    def with_edges(self, pairs: IntArray, weight: FloatArray, length: FloatArray) -> "SurfaceGraph":
        """Return the graph with more edges between nodes that have none yet; parallel new edges are summed.

        Parameters
        ----------
        pairs : (M, 2) node pairs, in any order.
        weight, length : (M,)
        """
        added = SurfaceGraph.with_sums(pairs, weight, self.volume, length)
        return SurfaceGraph(
            np.concatenate([self.edges, added.edges]),
            np.concatenate([self.weight, added.weight]),
            self.volume,
            np.concatenate([self.length, added.length]),
        )


@dataclass(frozen=True, slots=True, eq=False)
class EdgeIndex:
    """The edges of a graph by their nodes."""

    key: LongArray  # (E,) ascending, see ``segcore.arrays.pair_keys``
    edge: LongArray  # (E,) of these keys
    node_count: int

    @classmethod
    def of(cls, graph: SurfaceGraph) -> "EdgeIndex":
        key = pair_keys(graph.edges, graph.node_count)
        order = np.argsort(key, kind="stable")
        return cls(key[order], order, graph.node_count)

    def find(self, pairs: IntArray) -> LongArray:
        """(P,) the edge between the nodes of every pair (P, 2) in any order; -1 if there is none."""
        wanted = pair_keys(pairs, self.node_count)
        place = np.minimum(np.searchsorted(self.key, wanted), len(self.key) - 1)
        found: LongArray = np.where(self.key[place] == wanted, self.edge[place], -1)
        return found


def rows_of(edges: IntArray, node_count: int) -> Rows:
    """Return the adjacency lists of an edge list (E, 2); parallel edges are allowed. O(N + E)."""
    return rows_of_edges(edges, node_count)


def weighted_degrees(edges: IntArray, weight: FloatArray, node_count: int) -> FloatArray:
    """(N,) sum of the weights (E,) of the edges (E, 2) at every node."""
    return group_sums(edges.ravel(), np.repeat(weight, 2), node_count)


def connected_components(edges: IntArray, node_count: int) -> IntArray:
    """(N,) int32 component of every node, numbered 0, 1, ... by the smallest node of each.

    Parameters
    ----------
    edges : (E, 2) node pairs, in any order; loops and parallel edges are allowed.
    """
    return components_of_edges(edges, node_count)


def components_inside(edges: IntArray, group: IntArray) -> IntArray:
    """(N,) int32 connected component of every node in the graph of the edges that lie inside a group (N,)."""
    return components_within(edges, group)[0]


@kernel
def rows_of_edges(edges: IntArray, node_count: int) -> Rows:
    """``rows_of`` for use in other kernels."""
    start = np.zeros(node_count + 1, dtype=np.int32)
    for e in range(len(edges)):
        start[edges[e, 0] + 1] += 1
        start[edges[e, 1] + 1] += 1
    for i in range(node_count):
        start[i + 1] += start[i]
    filled = start[:node_count].copy()
    neighbour = np.empty(2 * len(edges), dtype=np.int32)
    edge = np.empty(2 * len(edges), dtype=np.int32)
    for e in range(len(edges)):
        for end in range(2):
            here = edges[e, end]
            neighbour[filled[here]] = edges[e, 1 - end]
            edge[filled[here]] = e
            filled[here] += 1
    return Rows(start, neighbour, edge)


@kernel
def induced_edges(edges: IntArray, nodes: IntArray, node_count: int) -> tuple[IntArray, IntArray]:
    """(M, 2) edges inside a set of nodes, numbered as in ``nodes``, and (M,) their indices in ``edges``."""
    local = np.full(node_count, -1, dtype=np.int32)
    for i in range(len(nodes)):
        local[nodes[i]] = i
    count = 0
    kept = np.empty(len(edges), dtype=np.int32)
    for e in range(len(edges)):
        if local[edges[e, 0]] >= 0 and local[edges[e, 1]] >= 0:
            kept[count] = e
            count += 1
    induced = np.empty((count, 2), dtype=np.int32)
    for k in range(count):
        a = local[edges[kept[k], 0]]
        b = local[edges[kept[k], 1]]
        induced[k, 0] = min(a, b)
        induced[k, 1] = max(a, b)
    return induced, kept[:count]


@kernel
def edges_between(edges: IntArray, group: IntArray | BoolArray) -> IntArray:
    """The edges between nodes of different groups (N,)."""
    found = np.empty(len(edges), np.int32)
    count = 0
    for e in range(len(edges)):
        if group[edges[e, 0]] != group[edges[e, 1]]:
            found[count] = e
            count += 1
    return found[:count].copy()


@kernel
def components_within(edges: IntArray, group: IntArray | BoolArray) -> tuple[IntArray, int]:
    """(N,) the components of a graph without the edges between groups of nodes (N,), and their number."""
    parent = np.arange(len(group)).astype(np.int32)
    for e in range(len(edges)):
        if group[edges[e, 0]] == group[edges[e, 1]]:
            _join(parent, edges[e, 0], edges[e, 1])
    return _numbered(parent)


@kernel
def components_of_edges(edges: IntArray, node_count: int) -> IntArray:
    """``connected_components`` for use in other kernels."""
    parent = np.arange(node_count).astype(np.int32)
    for e in range(len(edges)):
        _join(parent, edges[e, 0], edges[e, 1])
    return _numbered(parent)[0]


@inner_kernel
def _join(parent, a, b):  # type: ignore[no-untyped-def]
    """Union-find with path halving; the root of a component is its smallest node."""
    while parent[a] != a:
        parent[a] = parent[parent[a]]
        a = parent[a]
    while parent[b] != b:
        parent[b] = parent[parent[b]]
        b = parent[b]
    if a < b:
        parent[b] = a
    else:
        parent[a] = b


@inner_kernel
def _numbered(parent):  # type: ignore[no-untyped-def]
    """(N,) the components 0, 1, ... by their smallest nodes, and their number."""
    count = 0
    component = np.empty(len(parent), dtype=np.int32)
    for i in range(len(parent)):
        if parent[i] == i:
            component[i] = count
            count += 1
        else:
            component[i] = component[parent[i]]
    return component, count
