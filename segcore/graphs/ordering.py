"""Approximate minimum degree: an order of elimination that keeps the factor of a sparse symmetric matrix small."""

from typing import NamedTuple

import numpy as np

from segcore.arrays import BoolArray, IntArray, LongArray
from segcore.graphs.surface_graph import Rows
from segcore.jit.decorators import inner_kernel, kernel

# A row is dense, and eliminated last, from this many entries and from 10 sqrt(N) entries on: the limit of AMD, the
# authors' own code (Amestoy, Davis and Duff, Algorithm 837, ACM Trans. Math. Softw. 30, 2004).
LEAST_DENSE_ROW = 16
DENSE_ROW = 10.0


class Quotient(NamedTuple):
    """The quotient graph of an elimination: variables, which are left, and elements, which stand for cliques.

    The list of node i is memory[begin[i]]..memory[begin[i] + length[i]], its first ``elements[i]`` entries being
    elements. The list of an element is its clique.
    """

    begin: LongArray  # (N,)
    length: IntArray  # (N,)
    elements: IntArray  # (N,)
    size: IntArray  # (N,) number of nodes merged in a variable; 0 for all other nodes
    degree: IntArray  # (N,) bound of the neighbours of a variable; number of nodes in the clique of an element
    alive: BoolArray  # (N,) True for elements that no later one has absorbed
    clique_of: IntArray  # (N,) the last pivot whose clique a variable was in, or -1
    outside: IntArray  # (N,) nodes of an element, or neighbours of a variable, that are not in the clique of the pivot


class DegreeLists(NamedTuple):
    """The variables of every degree, as doubly linked lists; -1 ends a list."""

    first: IntArray  # (N + 1,)
    following: IntArray  # (N,)
    preceding: IntArray  # (N,)


class Members(NamedTuple):
    """The nodes that are merged in every variable, as linked lists; -1 ends a list."""

    following: IntArray  # (N,)
    last: IntArray  # (N,)


class Scratch(NamedTuple):
    """Work arrays of one elimination step."""

    counted_for: IntArray  # (N,) the last pivot for which an element was counted
    hashed: IntArray  # (N,) hash of the list of a variable
    bucket: IntArray  # (N,) first variable of every hash; -1 between steps
    following: IntArray  # (N,) the next variable of the same hash


def minimum_degree(rows: Rows) -> IntArray:
    """(N,) the nodes in an order of elimination with little fill.

    Nodes are eliminated by increasing (approximate) number of the neighbours that they have at that moment. An
    eliminated node becomes an *element*, the clique of its former neighbours; a node that is left, or *variable*, has
    a list of elements and one of variables. Variables with the same lists are merged and eliminated together.

    References
    ----------
    Amestoy, Davis and Duff, An approximate minimum degree ordering algorithm, SIAM J. Matrix Anal. Appl. 17, 1996.
    """
    dense = max(LEAST_DENSE_ROW, int(DENSE_ROW * (len(rows.start) - 1) ** 0.5))
    return _minimum_degree(rows, dense)


@kernel
def order_inside(order: IntArray, nodes: IntArray) -> IntArray:
    """(M,) the places in ``nodes`` (M,) of some nodes, in an order (N,) of all nodes.

    The elimination of a part of a graph in the order of the whole fills no more than that of the whole does there.
    """
    place = np.full(len(order), -1, dtype=np.int32)
    for i in range(len(nodes)):
        place[nodes[i]] = i
    inside = np.empty(len(nodes), dtype=np.int32)
    filled = 0
    for node in order:
        if place[node] >= 0:
            inside[filled] = place[node]
            filled += 1
    return inside


@kernel
def _minimum_degree(rows, dense):  # type: ignore[no-untyped-def]
    node_count = len(rows.start) - 1
    memory = rows.neighbour.copy()
    free = len(memory)
    graph = Quotient(
        rows.start[:node_count].astype(np.int64),
        _row_lengths(rows.start),
        np.zeros(node_count, dtype=np.int32),
        np.ones(node_count, dtype=np.int32),
        _row_lengths(rows.start),
        np.zeros(node_count, dtype=np.bool_),
        np.full(node_count, -1, dtype=np.int32),
        np.zeros(node_count, dtype=np.int32),
    )
    lists = DegreeLists(
        np.full(node_count + 1, -1, dtype=np.int32),
        np.full(node_count, -1, dtype=np.int32),
        np.full(node_count, -1, dtype=np.int32),
    )
    members = Members(np.full(node_count, -1, dtype=np.int32), np.arange(node_count).astype(np.int32))
    scratch = Scratch(
        np.full(node_count, -1, dtype=np.int32),
        np.full(node_count, -1, dtype=np.int32),
        np.full(node_count, -1, dtype=np.int32),
        np.full(node_count, -1, dtype=np.int32),
    )
    order = np.empty(node_count, dtype=np.int32)
    left = node_count
    for i in range(node_count):
        if graph.length[i] > dense:
            graph.size[i] = 0
            left -= 1
            order[left] = i
    _enter(np.arange(node_count), graph, lists)
    placed = 0
    least = 0
    while left > 0:
        while lists.first[least] < 0:
            least += 1
        pivot = lists.first[least]
        lists.first[least] = lists.following[pivot]
        if lists.following[pivot] >= 0:
            lists.preceding[lists.following[pivot]] = -1
        left -= graph.size[pivot]
        graph.size[pivot] = 0
        if free + graph.degree[pivot] > len(memory):
            larger = np.empty(2 * len(memory) + graph.degree[pivot], dtype=np.int32)
            for k in range(free):
                larger[k] = memory[k]
            memory = larger
        end = _form_clique(pivot, free, memory, graph)
        clique = memory[free:end]
        _leave(clique, graph, lists)
        _count_outside(pivot, clique, memory, graph, scratch)
        _shorten(pivot, clique, memory, graph, scratch)
        clique_size = 0
        for i in clique:
            if graph.outside[i] == 0:  # all neighbours of i are in the clique: it is eliminated with the pivot
                left -= graph.size[i]
                graph.size[i] = 0
                members.following[members.last[pivot]] = i
                members.last[pivot] = members.last[i]
            clique_size += graph.size[i]
        _merge_twins(clique, memory, graph, members, scratch)
        kept = 0
        for i in clique:
            if graph.size[i] > 0:
                bound = min(min(graph.degree[i], graph.outside[i]) + clique_size, left)
                graph.degree[i] = bound - graph.size[i]
                least = min(least, graph.degree[i])
                clique[kept] = i
                kept += 1
        _enter(clique[:kept], graph, lists)
        graph.begin[pivot] = free
        graph.length[pivot] = kept
        graph.degree[pivot] = clique_size
        graph.alive[pivot] = kept > 0
        free += kept
        member = pivot
        while member >= 0:
            order[placed] = member
            placed += 1
            member = members.following[member]
    return order


@inner_kernel
def _row_lengths(start):  # type: ignore[no-untyped-def]
    """``np.diff``, whose compilation takes two seconds."""
    length = np.empty(len(start) - 1, dtype=np.int32)
    for i in range(len(length)):
        length[i] = start[i + 1] - start[i]
    return length


@inner_kernel
def _enter(variables, graph, lists):  # type: ignore[no-untyped-def]
    """Put variables at the heads of the lists of their degrees."""
    size, degree = graph.size, graph.degree
    first, following, preceding = lists.first, lists.following, lists.preceding
    for i in variables:
        if size[i] > 0:
            following[i] = first[degree[i]]
            preceding[i] = -1
            if following[i] >= 0:
                preceding[following[i]] = i
            first[degree[i]] = i


@inner_kernel
def _leave(variables, graph, lists):  # type: ignore[no-untyped-def]
    """Take variables out of the lists of their degrees."""
    degree = graph.degree
    first, following, preceding = lists.first, lists.following, lists.preceding
    for i in variables:
        if following[i] >= 0:
            preceding[following[i]] = preceding[i]
        if preceding[i] >= 0:
            following[preceding[i]] = following[i]
        else:
            first[degree[i]] = following[i]


@inner_kernel
def _form_clique(pivot, free, memory, graph):  # type: ignore[no-untyped-def]
    """Write the variables around the pivot to ``memory`` from ``free`` on, and absorb its elements."""
    begin, length, size = graph.begin, graph.length, graph.size
    alive, clique_of = graph.alive, graph.clique_of
    variables = begin[pivot] + graph.elements[pivot]
    for k in range(begin[pivot], begin[pivot] + length[pivot]):
        other = memory[k]
        first = k
        last = k + 1
        if k < variables:
            if not alive[other]:
                continue
            alive[other] = False
            first = begin[other]
            last = first + length[other]
        for q in range(first, last):
            i = memory[q]
            if size[i] > 0 and clique_of[i] != pivot:
                clique_of[i] = pivot
                memory[free] = i
                free += 1
    return free


@inner_kernel
def _count_outside(pivot, clique, memory, graph, scratch):  # type: ignore[no-untyped-def]
    """Count the nodes outside the clique of the pivot for every element next to it, in ``outside``."""
    begin, elements, size, outside = graph.begin, graph.elements, graph.size, graph.outside
    counted_for = scratch.counted_for
    for i in clique:
        for q in range(begin[i], begin[i] + elements[i]):
            e = memory[q]
            if graph.alive[e]:
                if counted_for[e] != pivot:
                    counted_for[e] = pivot
                    outside[e] = graph.degree[e]
                outside[e] -= size[i]


@inner_kernel
def _shorten(pivot, clique, memory, graph, scratch):  # type: ignore[no-untyped-def]
    """Remove from the lists of the clique's variables what the clique covers, and add the pivot; hash the lists.

    ``outside[i]`` becomes a bound of the neighbours of variable i that are not in the clique.
    """
    begin, length, elements, size = graph.begin, graph.length, graph.elements, graph.size
    alive, clique_of, outside = graph.alive, graph.clique_of, graph.outside
    for i in clique:
        old_variables = begin[i] + elements[i]
        bound = 0
        total = 0
        put = begin[i]
        for q in range(begin[i], old_variables):
            e = memory[q]
            if alive[e] and outside[e] > 0:
                bound += outside[e]
                total += e
                memory[put] = e
                put += 1
            else:
                alive[e] = False
        variable_count = 0
        for q in range(old_variables, begin[i] + length[i]):
            j = memory[q]
            if size[j] > 0 and clique_of[j] != pivot:
                bound += size[j]
                total += j
                memory[old_variables + variable_count] = j
                variable_count += 1
        # i was reached through the pivot, or through an element that is dead by now: there is room for one more entry.
        if put == old_variables:
            memory[put + variable_count] = memory[put]
        else:
            for q in range(variable_count):
                memory[put + 1 + q] = memory[old_variables + q]
        memory[put] = pivot
        elements[i] = put + 1 - begin[i]
        length[i] = elements[i] + variable_count
        outside[i] = bound
        scratch.hashed[i] = total % len(size)


@inner_kernel
def _merge_twins(clique, memory, graph, members, scratch):  # type: ignore[no-untyped-def]
    """Merge the variables of the pivot's clique that have equal lists; variables of one hash share a bucket."""
    begin, length, elements, size = graph.begin, graph.length, graph.elements, graph.size
    hashed, bucket, following = scratch.hashed, scratch.bucket, scratch.following
    for i in clique:
        if size[i] > 0:
            following[i] = bucket[hashed[i]]
            bucket[hashed[i]] = i
    for member in clique:
        chosen = bucket[hashed[member]]
        bucket[hashed[member]] = -1
        while chosen >= 0:
            previous = chosen
            i = following[chosen]
            while i >= 0:
                same = length[i] == length[chosen] and elements[i] == elements[chosen]
                k = 0
                while same and k < length[i]:
                    same = memory[begin[i] + k] == memory[begin[chosen] + k]
                    k += 1
                if same:
                    size[chosen] += size[i]
                    size[i] = 0
                    members.following[members.last[chosen]] = i
                    members.last[chosen] = members.last[i]
                    following[previous] = following[i]
                else:
                    previous = i
                i = following[i]
            chosen = following[chosen]
