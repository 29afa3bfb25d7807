"""Cuts of a segment that is its own mirror image, such that the cut and its image can be made together.

Such a cut S is one of three kinds, sigma being the reflection: S is its own image; S is the image of its complement (a
mirror cut); or S and sigma S are disjoint, and both are cut off in one step (a pair).
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from segcore.array_kernels import ascending, assign
from segcore.arrays import BoolArray, FloatArray, IntArray
from segcore.graphs.cheeger import Cut, cut_of, ncc_of
from segcore.graphs.surface_graph import SurfaceGraph, components_of_edges, components_within
from segcore.jit.decorators import inner_kernel, kernel
from segcore.solvers.flow import spectrum, swept_sides

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
    network, vectors = spectrum(graph, order)
    functions, signs = _symmetric_functions(graph, image, vectors)
    improved, swept, valleys = np.split(swept_sides(network, functions), [1, 1 + len(functions)])
    sides = np.concatenate([improved, swept, signs, valleys])
    return [cut_of(graph, side) for side in _symmetric_cuts(graph, image, sides)]


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


def _symmetric_functions(graph: SurfaceGraph, image: IntArray, vectors: FloatArray) -> tuple[FloatArray, BoolArray]:
    """(K, N) the even parts of some vectors and the magnitudes of their odd parts, and (L, N) the signs of these.

    Parts that are rounding errors are left out.
    """
    functions, signs = [], []
    for values in vectors:
        even, odd = 0.5 * (values + values[image]), 0.5 * (values - values[image])
        if (graph.volume * even**2).sum() >= _LEAST_PART**2:
            functions.append(even)
        if (graph.volume * odd**2).sum() >= _LEAST_PART**2:
            functions.append(np.abs(odd))
            signs.append((odd > 0.0) | ((odd == 0.0) & (np.arange(len(image)) < image)))
    return np.array(functions), np.array(signs, dtype=np.bool_).reshape(-1, len(image))


@kernel
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
                assign(found[count], cut)
                count += 1
    return found[:count]


@inner_kernel
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


@inner_kernel
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


@inner_kernel
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


@inner_kernel
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


@inner_kernel
def _components_of(pieces: _Pieces, chosen: BoolArray) -> tuple[IntArray, int]:
    """(P,) the components of the chosen pieces (P,), -1 for the others, and their number."""
    kept = np.empty((len(pieces.edges), 2), dtype=np.int32)
    filled = 0
    for e in range(len(pieces.edges)):
        if chosen[pieces.edges[e, 0]] and chosen[pieces.edges[e, 1]]:
            kept[filled, 0], kept[filled, 1] = pieces.edges[e, 0], pieces.edges[e, 1]
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
