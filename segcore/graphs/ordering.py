"""Approximate minimum degree: an order of elimination that keeps the factor of a sparse symmetric matrix small."""

import numpy as np
from numba import njit

from segcore.arrays import IntArray
from segcore.graphs.surface_graph import Rows

LEAST_DENSE_ROW = 16  # a row is dense, and comes last, from this many entries and from 10 sqrt(N) entries on


def minimum_degree(rows: Rows) -> IntArray:
    """(N,): the nodes in an order of elimination with little fill.

    Nodes are eliminated by increasing (approximate) number of the neighbours that they have at that moment. An
    eliminated node becomes an *element*, the clique of its former neighbours; a node that is left, or *variable*, has
    a list of elements and one of variables. Variables with the same lists are merged and eliminated together.

    References
    ----------
    Amestoy, Davis and Duff, An approximate minimum degree ordering algorithm, SIAM J. Matrix Anal. Appl. 17, 1996.
    """
    dense = max(LEAST_DENSE_ROW, int(10 * (len(rows.start) - 1) ** 0.5))
    return _minimum_degree(rows.start, rows.neighbour, dense)


@njit(cache=True)
def _minimum_degree(adjacency_start, neighbour, dense):  # type: ignore[no-untyped-def]
    """The lists of node i are memory[begin[i]] ... of ``length[i]`` entries, the first ``elements[i]`` being elements.

    An element's list is its clique. ``size`` is the number of nodes merged in a variable, and 0 for everything else;
    ``degree`` bounds the neighbours of a variable and is the number of nodes in the clique of an element.
    """
    node_count = len(adjacency_start) - 1
    memory = neighbour.copy()
    free = len(memory)
    begin = np.empty(node_count, dtype=np.int64)
    length = np.empty(node_count, dtype=np.int32)
    elements = np.zeros(node_count, dtype=np.int32)
    size = np.ones(node_count, dtype=np.int32)
    degree = np.empty(node_count, dtype=np.int32)
    alive = np.zeros(node_count, dtype=np.bool_)  # True for elements that no later one has absorbed
    clique_of = np.full(node_count, -1, dtype=np.int32)  # the last pivot whose clique a variable was in
    outside = np.zeros(node_count, dtype=np.int32)
    scratch = np.full((4, node_count), -1, dtype=np.int32)
    first_of_degree = np.full(node_count + 1, -1, dtype=np.int32)
    next_of_degree = np.full(node_count, -1, dtype=np.int32)
    previous_of_degree = np.full(node_count, -1, dtype=np.int32)
    next_member = np.full(node_count, -1, dtype=np.int32)
    last_member = np.empty(node_count, dtype=np.int32)
    order = np.empty(node_count, dtype=np.int32)
    left = node_count
    for i in range(node_count):
        begin[i] = adjacency_start[i]
        length[i] = adjacency_start[i + 1] - adjacency_start[i]
        degree[i] = length[i]
        last_member[i] = i
        if length[i] > dense:
            size[i] = 0
            left -= 1
            order[left] = i
    _enter(np.arange(node_count), size, degree, first_of_degree, next_of_degree, previous_of_degree)
    placed = 0
    least = 0
    while left > 0:
        while first_of_degree[least] < 0:
            least += 1
        pivot = first_of_degree[least]
        first_of_degree[least] = next_of_degree[pivot]
        if next_of_degree[pivot] >= 0:
            previous_of_degree[next_of_degree[pivot]] = -1
        left -= size[pivot]
        size[pivot] = 0
        if free + degree[pivot] > len(memory):
            larger = np.empty(2 * len(memory) + degree[pivot], dtype=np.int32)
            for k in range(free):
                larger[k] = memory[k]
            memory = larger
        end = _form_clique(pivot, free, memory, begin, length, elements, size, alive, clique_of)
        clique = memory[free:end]
        _leave(clique, degree, first_of_degree, next_of_degree, previous_of_degree)
        _count_outside(pivot, clique, memory, begin, elements, size, degree, alive, outside, scratch)
        _shorten(pivot, clique, memory, begin, length, elements, size, alive, clique_of, outside, scratch)
        clique_size = 0
        for i in clique:
            if outside[i] == 0:  # nothing but the clique is left around i: it is eliminated with the pivot
                left -= size[i]
                size[i] = 0
                next_member[last_member[pivot]] = i
                last_member[pivot] = last_member[i]
            clique_size += size[i]
        _merge_twins(clique, memory, begin, length, elements, size, next_member, last_member, scratch)
        kept = 0
        for i in clique:
            if size[i] > 0:
                degree[i] = min(min(degree[i], outside[i]) + clique_size, left) - size[i]
                least = min(least, degree[i])
                clique[kept] = i
                kept += 1
        _enter(clique[:kept], size, degree, first_of_degree, next_of_degree, previous_of_degree)
        begin[pivot] = free
        length[pivot] = kept
        degree[pivot] = clique_size
        alive[pivot] = kept > 0
        free += kept
        member = pivot
        while member >= 0:
            order[placed] = member
            placed += 1
            member = next_member[member]
    return order


@njit(cache=True)
def _enter(variables, size, degree, first, following, preceding):  # type: ignore[no-untyped-def]
    """Put variables at the heads of the lists of those of their degrees."""
    for i in variables:
        if size[i] > 0:
            following[i] = first[degree[i]]
            preceding[i] = -1
            if following[i] >= 0:
                preceding[following[i]] = i
            first[degree[i]] = i


@njit(cache=True)
def _leave(variables, degree, first, following, preceding):  # type: ignore[no-untyped-def]
    for i in variables:
        if following[i] >= 0:
            preceding[following[i]] = preceding[i]
        if preceding[i] >= 0:
            following[preceding[i]] = following[i]
        else:
            first[degree[i]] = following[i]


@njit(cache=True)
def _form_clique(pivot, free, memory, begin, length, elements, size, alive, clique_of):  # type: ignore[no-untyped-def]
    """Write the variables around the pivot to ``memory`` from ``free`` on, and absorb its elements."""
    variables = begin[pivot] + elements[pivot]
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


@njit(cache=True)
def _count_outside(pivot, clique, memory, begin, elements, size, degree, alive, outside, scratch):  # type: ignore[no-untyped-def]
    """``outside[e]``: the nodes of element e that are not in the pivot's clique, for every element next to it."""
    counted_for = scratch[0]
    for i in clique:
        for q in range(begin[i], begin[i] + elements[i]):
            e = memory[q]
            if alive[e]:
                if counted_for[e] != pivot:
                    counted_for[e] = pivot
                    outside[e] = degree[e]
                outside[e] -= size[i]


@njit(cache=True)
def _shorten(pivot, clique, memory, begin, length, elements, size, alive, clique_of, outside, scratch):  # type: ignore[no-untyped-def]
    """Take from the lists of the clique's variables what the clique covers, and put the pivot in; hash the lists.

    ``outside[i]`` becomes a bound of the neighbours of variable i that are not in the clique.
    """
    hashed = scratch[1]
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
        hashed[i] = total % len(size)


@njit(cache=True)
def _merge_twins(clique, memory, begin, length, elements, size, next_member, last_member, scratch):  # type: ignore[no-untyped-def]
    """Merge the variables of the pivot's clique whose lists are the same; those of one hash are in one bucket."""
    hashed = scratch[1]
    bucket = scratch[2]
    following = scratch[3]
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
                    next_member[last_member[chosen]] = i
                    last_member[chosen] = last_member[i]
                    following[previous] = following[i]
                else:
                    previous = i
                i = following[i]
            chosen = following[chosen]
