"""Cuts of a segment that is its own mirror image, such that the cut and its image can be made together.

Such a cut S is one of three kinds, sigma being the reflection: S is its own image; S is the image of its complement (a
mirror cut); or S and sigma S are disjoint, and both are cut off in one step (a pair).
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numba import njit

from segcore.array_kernels import ascending
from segcore.arrays import BoolArray, FloatArray, IntArray
from segcore.graphs.cheeger import Cut, best_level_set, cut_of, cut_sums, level_sets, ncc_of, valley_sides
from segcore.graphs.max_flow import network_of
from segcore.graphs.surface_graph import SurfaceGraph, components_of_edges, components_within
from segcore.solvers.fiedler import eigenvectors_of, start_noise
from segcore.solvers.flow import VALLEYS, VECTORS, improved

_LEAST_PART = 0.05  # norm of the even or odd part of an eigenvector of norm 1; a smaller one is a rounding error
_MOST_PIECES = 8  # of a cut that are compared, the best ones; set by hand


def symmetric_sweeps(graph: SurfaceGraph, image: IntArray, order: IntArray) -> list[Cut]:
    """Symmetric cuts from the even and odd parts of several eigenvectors, the best of them improved by maximum flows.

    An even function is swept. So is the magnitude of an odd one, which gives pairs, and its sign gives a mirror cut.

    Parameters
    ----------
    graph : connected, at least two nodes.
    image : (N,) the image of every node, an automorphism of the graph without a fixed point.
    order : (N,) of the elimination of the nodes.
    """
    return [cut_of(graph, side) for side in _symmetric_sweeps(graph, image, order, start_noise(graph.node_count))]


def symmetric_cuts(graph: SurfaceGraph, image: IntArray, sides: Sequence[BoolArray]) -> list[Cut]:
    """Different symmetric cuts next to the given ones; every part into which they cut the graph is connected.

    Parameters
    ----------
    graph : connected.
    image : (N,) the image of every node, an involution without a fixed point.
    sides : (N,) each, with any symmetry.
    """
    return [cut_of(graph, side) for side in _symmetric_cuts(graph, image, np.stack(sides))] if sides else []


def second_of_pair(side: BoolArray, image: IntArray) -> BoolArray | None:
    """(N,) the image of one side of a cut if they are disjoint but not complements; None otherwise."""
    mirrored = side[image]
    return None if (side & mirrored).any() or (side | mirrored).all() else mirrored


@njit(cache=True)
def _symmetric_sweeps(graph: SurfaceGraph, image: IntArray, order: IntArray, noise: FloatArray) -> BoolArray:
    """(C, N) ``symmetric_sweeps``."""
    network = network_of(graph, order)
    vectors = eigenvectors_of(graph, network.factor, noise, VECTORS)
    count = len(image)
    even = np.empty((2 * len(vectors), count))
    signs = np.empty((len(vectors), count), dtype=np.bool_)
    evens = odds = 0
    for values in vectors:
        mirrored = values[image]
        if _norm(graph, 0.5 * (values + mirrored)) >= _LEAST_PART:
            even[evens] = 0.5 * (values + mirrored)
            evens += 1
        part = 0.5 * (values - mirrored)
        if _norm(graph, part) >= _LEAST_PART:
            even[evens] = np.abs(part)
            evens += 1
            for i in range(count):
                signs[odds, i] = part[i] > 0.0 or (part[i] == 0.0 and i < image[i])
            odds += 1
    sides = np.empty((1 + (1 + VALLEYS) * evens + odds, count), dtype=np.bool_)
    necks = np.empty((VALLEYS * evens, count), dtype=np.bool_)
    best, least, filled, found = 1, np.inf, 1, 0
    for e in range(evens):
        levels = level_sets(graph, even[e])
        sides[filled] = best_level_set(even[e], levels, False)
        ncc = ncc_of(*cut_sums(graph, sides[filled]))
        if ncc < least:
            best, least = filled, ncc
        filled += 1
        for neck in valley_sides(levels, VALLEYS):
            necks[found] = neck
            found += 1
    for side in signs[:odds]:
        sides[filled] = side
        filled += 1
    for side in necks[:found]:
        sides[filled] = side
        filled += 1
    sides[0] = improved(network, sides[best]) if least < np.inf else sides[best]
    return _symmetric_cuts(graph, image, sides[:filled])


@njit(cache=True)
def _norm(graph: SurfaceGraph, values: FloatArray) -> float:
    total = 0.0
    for i in range(len(values)):
        total += graph.volume[i] * values[i] ** 2
    return np.sqrt(total)


@njit(cache=True)
def _symmetric_cuts(graph: SurfaceGraph, image: IntArray, sides: BoolArray) -> BoolArray:
    """(C, N) ``symmetric_cuts``. Cuts that are images of each other count as one.

    A set of which neither it nor its complement is its image stands for its union and its overlap with the image.
    """
    found = np.empty((2 * len(sides), len(image)), dtype=np.bool_)
    count = 0
    for side in sides:
        mirrored = side[image]
        is_symmetric = (side == mirrored).all() or (side != mirrored).all()
        for is_union in (True, False):
            if is_symmetric:
                symmetric = side
            elif is_union:
                symmetric = side | mirrored
            else:
                symmetric = side & mirrored
            if (is_symmetric and not is_union) or not symmetric.any() or symmetric.all():
                continue
            cut = _best_star(graph, image, symmetric)
            if cut.any() and not _is_among(cut, image, found[:count]):
                found[count] = cut
                count += 1
    return found[:count]


@njit(cache=True)
def _is_among(side: BoolArray, image: IntArray, found: BoolArray) -> bool:
    """Whether a bipartition or its image is among others."""
    for other in found:
        is_same, is_image = True, True
        for i in range(len(side)):
            on_side = side[i] == side[0]
            is_same = is_same and on_side == (other[i] == other[0])
            is_image = is_image and on_side == (other[image[i]] == other[image[0]])
        if is_same or is_image:
            return True
    return False


class _Pieces(NamedTuple):
    """The pieces into which a symmetric set of nodes cuts a graph, and the edges between them."""

    of_node: IntArray  # (N,)
    opposite: IntArray  # (P,) the image of every piece
    edges: IntArray  # (Q, 2)
    weight: FloatArray  # (Q,)
    volume: FloatArray  # (P,)


@njit(cache=True)
def _best_star(graph: SurfaceGraph, image: IntArray, side: BoolArray) -> BoolArray:
    """(N,) a set that can be cut off with its image so that the rest is connected; empty if there is none.

    The pieces are the connected components of both sides, the one of least NCC first. If the rest of a piece is not
    connected, the components of the rest are tried next.

    Parameters
    ----------
    side : (N,) its own image, or the image of its complement.
    """
    pieces = _pieces(graph, image, side)
    count = len(pieces.volume)
    for p in _by_ncc(pieces, np.arange(count).astype(np.int32), count)[:_MOST_PIECES]:
        rest = np.ones(count, dtype=np.bool_)
        rest[p] = rest[pieces.opposite[p]] = False
        component, components = _components_of(pieces, rest)
        if components <= 1:
            return pieces.of_node == p
        for c in _by_ncc(pieces, component, components)[:_MOST_PIECES]:
            for q in range(count):
                rest[q] = component[q] != c and component[pieces.opposite[q]] != c
            if _components_of(pieces, rest)[1] <= 1:
                return (component == c)[pieces.of_node]
    return np.zeros(len(side), dtype=np.bool_)


@njit(cache=True)
def _pieces(graph: SurfaceGraph, image: IntArray, side: BoolArray) -> _Pieces:
    of_node, count = components_within(graph.edges, side)
    opposite = np.empty(count, dtype=np.int32)
    volume = np.zeros(count)
    for i in range(len(of_node)):
        opposite[of_node[i]] = of_node[image[i]]
        volume[of_node[i]] += graph.volume[i]
    edges, weight = np.empty((len(graph.edges), 2), dtype=np.int32), np.empty(len(graph.edges))
    filled = 0
    for e in range(len(graph.edges)):
        a, b = graph.edges[e, 0], graph.edges[e, 1]
        if side[a] != side[b]:
            edges[filled, 0], edges[filled, 1], weight[filled] = of_node[a], of_node[b], graph.weight[e]
            filled += 1
    return _Pieces(of_node, opposite, edges[:filled], weight[:filled], volume)


@njit(cache=True)
def _by_ncc(pieces: _Pieces, group: IntArray, count: int) -> IntArray:
    """(K,) groups 0..K - 1 of the pieces (P,) by increasing NCC; pieces of group -1 belong to none."""
    border, volume = np.zeros(count), np.zeros(count)
    for e in range(len(pieces.edges)):
        a, b = group[pieces.edges[e, 0]], group[pieces.edges[e, 1]]
        if a != b:
            if a >= 0:
                border[a] += pieces.weight[e]
            if b >= 0:
                border[b] += pieces.weight[e]
    total = pieces.volume.sum()
    for p in range(len(group)):
        if group[p] >= 0:
            volume[group[p]] += pieces.volume[p]
    for k in range(count):
        border[k] = ncc_of(border[k], volume[k], total - volume[k])
    return ascending(border)


@njit(cache=True)
def _components_of(pieces: _Pieces, chosen: BoolArray) -> tuple[IntArray, int]:
    """(P,) the components of the chosen pieces (P,), -1 for the others, and their number."""
    kept = np.empty((len(pieces.edges), 2), dtype=np.int32)
    filled = 0
    for e in range(len(pieces.edges)):
        if chosen[pieces.edges[e, 0]] and chosen[pieces.edges[e, 1]]:
            kept[filled] = pieces.edges[e]
            filled += 1
    component = components_of_edges(kept[:filled], len(chosen))
    number = np.full(len(chosen), -1, dtype=np.int32)
    count = 0
    for p in range(len(chosen)):
        if not chosen[p]:
            component[p] = -1
        else:
            if number[component[p]] < 0:
                number[component[p]] = count
                count += 1
            component[p] = number[component[p]]
    return component, count
