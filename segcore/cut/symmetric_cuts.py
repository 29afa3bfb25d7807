"""Cuts of a segment that is its own mirror image, such that the cut and its image can be made together.

Such a cut S is one of three kinds, sigma being the reflection: S is its own image; S is the image of its complement (a
mirror cut); or S and sigma S are disjoint, and both are cut off in one step (a pair).
"""

import numpy as np

from segcore.array_kernels import dot
from segcore.arrays import BoolArray, FloatArray, IntArray, group_sums
from segcore.graphs.cheeger import Cut, cut_of, sweep, valleys
from segcore.graphs.max_flow import Network
from segcore.graphs.surface_graph import SurfaceGraph, connected_components
from segcore.solvers.fiedler import eigenvectors
from segcore.solvers.flow import VALLEYS, improve

_VECTORS = 3  # eigenvectors after the constant one, as many as cuts of other segments have
_LEAST_PART = 0.05  # norm of the even or odd part of an eigenvector of norm 1; a smaller one is a rounding error
_MOST_PIECES = 8  # of a cut that are compared, the best ones; set by hand


def symmetric_sweeps(graph: SurfaceGraph, image: IntArray) -> list[Cut]:
    """Symmetric cuts from the even and odd parts of several eigenvectors, the best of them improved by maximum flows.

    An even function is swept. So is the magnitude of an odd one, which gives pairs, and its sign gives a mirror cut.

    Parameters
    ----------
    graph : connected, at least two nodes.
    image : (N,) the image of every node, an automorphism of the graph without a fixed point.
    """
    network = Network.of(graph)
    vectors = eigenvectors(graph, network.factor, _VECTORS).T
    even: list[FloatArray] = []
    signs: list[BoolArray] = []
    for values in vectors:
        part = 0.5 * (values + values[image])
        if dot(graph.volume, part**2) >= _LEAST_PART**2:
            even.append(part)
        part = 0.5 * (values - values[image])
        if dot(graph.volume, part**2) >= _LEAST_PART**2:
            even.append(np.abs(part))
            signs.append((part > 0.0) | ((part == 0.0) & (np.arange(len(part)) < image)))
    sweeps = [sweep(graph, part) for part in even]
    necks = [cut.side for part in even for cut in valleys(graph, part, VALLEYS)]
    best = min(sweeps, key=lambda cut: cut.ncc)
    sides = [improve(network, best).side if np.isfinite(best.ncc) else best.side]
    return symmetric_cuts(graph, image, [*sides, *(cut.side for cut in sweeps), *signs, *necks])


def symmetric_cuts(graph: SurfaceGraph, image: IntArray, sides: list[BoolArray]) -> list[Cut]:
    """Different symmetric cuts next to the given ones; every part into which they cut the graph is connected.

    Parameters
    ----------
    graph : connected.
    image : (N,) the image of every node, an involution without a fixed point.
    sides : (N,) each, with any symmetry.
    """
    found: dict[bytes, Cut] = {}
    for side in sides:
        for symmetric in _symmetric_sides(side, image):
            cut = _best_star(graph, image, symmetric)
            if cut is not None:
                found.setdefault(min(cut.key, Cut(cut.side[image], 0.0, 0.0, 0.0).key), cut)
    return list(found.values())


def second_of_pair(side: BoolArray, image: IntArray) -> BoolArray | None:
    """(N,) the image of one side of a cut if they are disjoint but not complements; None otherwise."""
    mirrored = side[image]
    return None if (side & mirrored).any() or (side | mirrored).all() else mirrored


def _symmetric_sides(side: BoolArray, image: IntArray) -> list[BoolArray]:
    """The set itself if it or its complement is its image; else its union and its overlap with the image."""
    mirrored = side[image]
    if (side == mirrored).all() or (side != mirrored).all():
        return [side]
    return [both for both in (side | mirrored, side & mirrored) if both.any() and not both.all()]


def _best_star(graph: SurfaceGraph, image: IntArray, side: BoolArray) -> Cut | None:
    """A cut that cuts off a piece so that it and its image leave a connected rest; None if there is none.

    The pieces are the connected components of both sides, the one of least NCC first. If the rest of a piece is not
    connected, the components of the rest are tried next.

    Parameters
    ----------
    side : (N,) its own image, or the image of its complement.
    """
    a, b = graph.edges.T
    piece = connected_components(graph.edges[side[a] == side[b]], graph.node_count)
    count = int(piece.max()) + 1
    if count < 2:
        return None
    opposite = np.empty(count, dtype=np.int32)
    opposite[piece] = piece[image]
    across = side[a] != side[b]
    pieces = SurfaceGraph(
        piece[graph.edges[across]], graph.weight[across], group_sums(piece, graph.volume), graph.length[across]
    )
    single = np.eye(count, dtype=bool)
    for p in _by_ncc(pieces, single)[:_MOST_PIECES]:
        rest = ~(single[p] | single[p][opposite])
        component = connected_components(pieces.edges[rest[pieces.edges].all(axis=1)], count)
        remaining = np.unique(component[rest])
        if len(remaining) <= 1:
            return cut_of(graph, single[p][piece])
        components = component == remaining[:, None]
        for r in _by_ncc(pieces, components)[:_MOST_PIECES]:
            if _is_connected(pieces, ~(components[r] | components[r][opposite])):
                return cut_of(graph, components[r][piece])
    return None


def _by_ncc(graph: SurfaceGraph, sets: BoolArray) -> list[int]:
    """The sets of nodes (K, N) by increasing NCC."""
    crossing = sets[:, graph.edges[:, 0]] != sets[:, graph.edges[:, 1]]
    volume = sets @ graph.volume
    ratio = (crossing @ graph.weight) / np.minimum(volume, graph.total_volume - volume)
    order: list[int] = np.argsort(ratio, kind="stable").tolist()
    return order


def _is_connected(graph: SurfaceGraph, chosen: BoolArray) -> bool:
    """True if the chosen nodes (N,) are connected, or if there are none."""
    component = connected_components(graph.edges[chosen[graph.edges].all(axis=1)], graph.node_count)
    return len(np.unique(component[chosen])) <= 1
