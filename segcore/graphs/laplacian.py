"""Sparse elimination of a graph Laplacian: a factor with which L x = b is solved many times."""

from typing import NamedTuple

import numpy as np

from segcore.arrays import FloatArray, IntArray, LongArray
from segcore.graphs.ordering import minimum_degree
from segcore.graphs.surface_graph import IndexArray, Rows, SurfaceGraph, rows_of
from segcore.jit.decorators import inner_kernel, kernel


class LaplacianFactor(NamedTuple):
    """L = (I - C) diag(pivot) (I - C)^T with rows and columns in an order of elimination.

    Column k of C is sparse, non-negative, below the diagonal, and sums to 1; it is empty, with pivot 0, for the last
    node of every component.
    """

    order: IntArray  # (N,) node k of the elimination is node order[k] of the graph
    start: LongArray  # (N + 1,) column k has the entries start[k]..start[k + 1]
    row: IndexArray  # (nnz,) ascending in each column
    share: FloatArray  # (nnz,) the entries of C
    pivot: FloatArray  # (N,)

    @property
    def component_count(self) -> int:
        """The number of components of the graph."""
        return len(self.pivot) - int(np.count_nonzero(self.pivot))

    def solve(self, b: FloatArray) -> FloatArray:
        """(N,) a solution x of L x = b.

        x is determined up to a constant on every component; the one returned is 0 at the node eliminated last.

        Parameters
        ----------
        b : (N,) with sum 0 over every component.
        """
        return substitute(*self, b)


class Elimination(NamedTuple):
    """The part of a factorisation that does not depend on the weights: an order and the places of the entries."""

    rows: Rows
    order: IntArray  # (N,) as in ``LaplacianFactor``, likewise the next two
    start: LongArray  # (N + 1,)
    row: IndexArray  # (nnz,)

    @classmethod
    def of(cls, edges: IntArray, node_count: int) -> "Elimination":
        """Order the elimination of an edge list (E, 2), each node pair listed once, without loops."""
        rows = rows_of(edges, node_count)
        order = minimum_degree(rows)
        return cls(rows, order, *_structure(rows, order))

    def factorise(self, weight: FloatArray) -> LaplacianFactor:
        """Factorise the Laplacian for weights (E,) > 0 of the edges."""
        share, pivot = _eliminate(self.rows, weight[self.rows.edge], self.order, self.start, self.row)
        return LaplacianFactor(self.order, self.start, self.row, share, pivot)


def factorise(graph: SurfaceGraph) -> LaplacianFactor:
    """Factorise L = diag(degree) - W by Gaussian elimination."""
    return factorise_edges(graph.edges, graph.weight, graph.node_count)


def factorise_edges(edges: IntArray, weight: FloatArray, node_count: int) -> LaplacianFactor:
    """Factorise the Laplacian of an edge list by Gaussian elimination.

    A Laplacian after an elimination is a Laplacian again, so that a pivot is the sum of the weights in its row. No
    number is ever subtracted, and every entry of the factor is accurate in all its digits for weights of any range.

    Parameters
    ----------
    edges : (E, 2) node pairs, each listed once, without loops.
    weight : (E,) > 0.

    References
    ----------
    Grassmann, Taksar and Heyman, Regenerative analysis and steady state distributions for Markov chains, Operations
    Research 33, 1985; George and Liu, Computer solution of large sparse positive definite systems, 1981, ch. 5.
    """
    return Elimination.of(edges, node_count).factorise(weight)


@inner_kernel
def factor_of(rows: Rows, weight: FloatArray, order: IntArray) -> LaplacianFactor:
    """``factorise_edges`` of the rows of an edge list, in an order of elimination, for use in other kernels."""
    start, row = _structure(rows, order)
    share, pivot = _eliminate(rows, weight[rows.edge], order, start, row)
    return LaplacianFactor(order, start, row, share, pivot)


@kernel
def _structure(rows, order):  # type: ignore[no-untyped-def]
    """``start`` and ``row`` of the factor: row i has entries on the tree paths from its neighbours up to i.

    The tree is the elimination tree: the parent of k is the first row below the diagonal of column k.
    """
    adjacency_start, neighbour = rows.start, rows.neighbour
    node_count = len(order)
    rank = np.empty(node_count, dtype=np.int32)
    for k in range(node_count):
        rank[order[k]] = k
    parent = np.full(node_count, -1, dtype=np.int32)
    visited_by = np.arange(node_count).astype(np.int32)
    start = np.zeros(node_count + 1, dtype=np.int64)
    for i in range(node_count):
        visited_by[i] = i
        for entry in range(adjacency_start[order[i]], adjacency_start[order[i] + 1]):
            k = rank[neighbour[entry]]
            while k < i and visited_by[k] != i:
                visited_by[k] = i
                start[k + 1] += 1
                if parent[k] < 0:
                    parent[k] = i
                k = parent[k]
    for k in range(node_count):
        start[k + 1] += start[k]
    filled = start[:node_count].copy()
    row = np.empty(start[node_count], dtype=np.uint32)
    visited_by[:] = -1
    for i in range(node_count):
        visited_by[i] = i
        for entry in range(adjacency_start[order[i]], adjacency_start[order[i] + 1]):
            k = rank[neighbour[entry]]
            while k < i and visited_by[k] != i:
                visited_by[k] = i
                row[filled[k]] = i
                filled[k] += 1
                k = parent[k]
    return start, row


@kernel
def _eliminate(rows, weight, order, start, row):  # type: ignore[no-untyped-def]
    """``share`` and ``pivot`` of the factor, left-looking: column k adds up the updates from earlier columns.

    ``waiting[k]`` heads a list, linked by ``next_column``, of the columns whose entry at ``reached`` is in row k.

    Parameters
    ----------
    weight : (2 E,) of the entries of the rows.
    """
    adjacency_start, neighbour = rows.start, rows.neighbour
    node_count = len(order)
    rank = np.empty(node_count, dtype=np.int32)
    for k in range(node_count):
        rank[order[k]] = k
    share = np.empty(len(row))
    pivot = np.zeros(node_count)
    column = np.zeros(node_count)
    waiting = np.full(node_count, -1, dtype=np.int32)
    next_column = np.full(node_count, -1, dtype=np.int32)
    reached = start[:node_count].copy()
    for k in range(node_count):
        for entry in range(adjacency_start[order[k]], adjacency_start[order[k] + 1]):
            column[rank[neighbour[entry]]] = weight[entry]
        j = waiting[k]
        while j >= 0:
            following = next_column[j]
            passed = share[reached[j]] * pivot[j]
            reached[j] += 1
            first, end = reached[j], start[j + 1]
            if first < end and row[end - 1] - row[first] == end - 1 - first:  # rows that follow each other
                below = column[row[first] : row[end - 1] + 1]
                for p in range(end - first):  # by vector instructions
                    below[p] += share[first + p] * passed
            else:
                for p in range(first, end):
                    column[row[p]] += share[p] * passed
            if first < end:
                next_column[j] = waiting[row[reached[j]]]
                waiting[row[reached[j]]] = j
            j = following
        for p in range(start[k], start[k + 1]):
            pivot[k] += column[row[p]]
        for p in range(start[k], start[k + 1]):
            share[p] = column[row[p]] / pivot[k]
            column[row[p]] = 0.0
        if start[k] < start[k + 1]:
            next_column[k] = waiting[row[start[k]]]
            waiting[row[start[k]]] = k
    return share, pivot


@kernel
def substitute(order, start, row, share, pivot, b):  # type: ignore[no-untyped-def]
    """Forward and backward substitution: ``LaplacianFactor.solve`` for use in other kernels.

    It takes the arrays of the factor one by one, because it is called so often that a named tuple would cost time.
    """
    node_count = len(order)
    y = np.empty(node_count)
    for k in range(node_count):
        y[k] = b[order[k]]
    for k in range(node_count):
        here = y[k]
        for p in range(start[k], start[k + 1]):
            y[row[p]] += share[p] * here
    x = np.empty(node_count)
    for k in range(node_count - 1, -1, -1):
        here = y[k] / pivot[k] if pivot[k] > 0 else 0.0
        for p in range(start[k], start[k + 1]):
            here += share[p] * y[row[p]]
        y[k] = here
        x[order[k]] = here
    return x
