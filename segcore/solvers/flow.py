"""Improvement of cuts by maximum flows: the default solver."""

from itertools import islice

import numpy as np

from segcore.array_kernels import assign
from segcore.arrays import BoolArray, FloatArray, IntArray
from segcore.graphs.cheeger import (
    Cut,
    best_level_set,
    cut_of,
    cut_sums,
    distinct_cuts,
    level_sets,
    ncc_of,
    valley_sides,
)
from segcore.graphs.connected_sides import connected_side
from segcore.graphs.max_flow import Network, minimum_cut, network_of
from segcore.graphs.surface_graph import SurfaceGraph
from segcore.jit.decorators import kernel
from segcore.solvers.fiedler import eigenvectors, eigenvectors_of, start_noise
from segcore.solvers.total_variation import TotalVariationFlow

# Set by hand. The first three are compared with their neighbours in bench/RESULTS.md, "Constants and their neighbours".
STEPS = 4  # of total variation flow from every eigenvector
ITERATIONS = 5  # of split Bregman in a step
WORST_IMPROVED = 1.35  # times the best value so far: cuts with a larger one are not improved
VECTORS = 3  # eigenvectors after the constant one, for the candidates
VALLEYS = 1  # of every eigenvector, among the candidates; set by hand
LEAST_GAIN = 1e-12  # relative decrease of the value; a smaller one is rounding error


def flow_cut(graph: SurfaceGraph, *, count: int = 2) -> Cut:
    """Return the cut of least normalized Cheeger cut that is reached from several eigenvectors.

    From each eigenvector a few steps of total variation flow are made, which leave the neighbourhood of its sweep. The
    best cut of the steps is then improved by maximum flows. The result is never worse than the sweep of the Fiedler
    vector.

    Parameters
    ----------
    graph : connected, at least two nodes.
    count : how many eigenvectors after the constant one, at least 1.

    Returns
    -------
    The cut, node 0 in S.

    Raises
    ------
    ValueError
        If the graph is not connected.

    References
    ----------
    Bresson, Laurent, Uminsky and von Brecht, Convergence and energy landscape for Cheeger cut clustering, NIPS 2012;
    Andersen and Lang, An algorithm for improving graph partitions, SODA 2008.
    """
    network = Network.of(graph)
    vectors = eigenvectors(graph, network.factor, count).T
    flow = TotalVariationFlow.of(graph, vectors[0])
    passed = [min(islice(flow.cuts(values, ITERATIONS), STEPS + 1), key=_ncc) for values in vectors]
    different = {cut.key: cut for cut in passed}
    best, *others = sorted(different.values(), key=_ncc)
    best = improve(network, best)
    promising = [cut for cut in others if cut.ncc <= WORST_IMPROVED * best.ncc]
    return min([best, *(improve(network, cut) for cut in promising)], key=_ncc).canonical


def connected_sweeps(graph: SurfaceGraph, order: IntArray) -> BoolArray:
    """(C, N) different cuts of a connected graph with connected sides; node 0 is on the side of each.

    They are the ``swept_sides`` of several eigenvectors.

    Parameters
    ----------
    graph : connected, at least two nodes.
    order : (N,) of the elimination of the nodes.
    """
    network, vectors = spectrum(graph, order)
    sides: BoolArray = _with_connected_sides(graph, swept_sides(network, vectors))
    return sides


def spectrum(graph: SurfaceGraph, order: IntArray) -> tuple[Network, FloatArray]:
    """The network of a connected graph, and (K, N) its first eigenvectors after the constant one.

    Parameters
    ----------
    order : (N,) of the elimination of the nodes.
    """
    network = network_of(graph, order)
    return network, eigenvectors_of(graph, network.factor, start_noise(graph.node_count), VECTORS)


@kernel
def swept_sides(network: Network, functions: FloatArray) -> BoolArray:
    """(C, N) sides of cuts: the best of the sweeps of K functions improved by maximum flows, the sweeps, their valleys.

    Parameters
    ----------
    network : of a connected graph.
    functions : (K, N)
    """
    graph, count = network.graph, len(functions)
    sides = np.empty((1 + (1 + VALLEYS) * count, functions.shape[1]), dtype=np.bool_)
    best, least, filled = 1, np.inf, 1 + count
    for k in range(count):
        levels = level_sets(graph, functions[k])
        assign(sides[1 + k], best_level_set(functions[k], levels, False))
        ncc = ncc_of(*cut_sums(graph, sides[1 + k]))
        if ncc < least:
            best, least = 1 + k, ncc
        valleys = valley_sides(levels, VALLEYS)
        for v in range(len(valleys)):
            assign(sides[filled], valleys[v])
            filled += 1
    assign(sides[0], improved(network, sides[best]) if least < np.inf else sides[best])
    return sides[:filled]


@kernel
def _with_connected_sides(graph: SurfaceGraph, sides: BoolArray) -> BoolArray:
    """(K, N) the different cuts among some (C, N), with connected sides."""
    different = distinct_cuts(sides)
    for k in range(len(different)):
        assign(different[k], connected_side(graph, different[k]))
    return distinct_cuts(different)


def improve(network: Network, cut: Cut) -> Cut:
    """Lower the normalized Cheeger cut of a bipartition by maximum flows until no flow lowers it any further.

    With S the smaller side, r = vol(S) / vol(T) and q = NCC(S), a maximum flow finds the set A of least

        cut(A) - q (vol(A and S) - r vol(A without S)).

    The subtracted term is at most q min(vol(A), vol(rest)). A negative value therefore implies NCC(A) < q, and A
    replaces S. At the end no set has a negative value; in particular no subset of S has a lower NCC.

    Parameters
    ----------
    network : of a connected graph.
    cut : of this graph, neither side empty.

    References
    ----------
    Andersen and Lang, An algorithm for improving graph partitions, SODA 2008; Hein and Setzer, Beyond spectral
    clustering: tight relaxations of balanced graph cuts, NIPS 2011.
    """
    return cut_of(network.graph, improved(network, cut.side))


@kernel
def improved(network: Network, side: BoolArray) -> BoolArray:
    """(N,) ``improve`` of the side (N,) of a cut."""
    graph = network.graph
    weight, inside, outside = cut_sums(graph, side)
    ncc = ncc_of(weight, inside, outside)
    supply = np.empty(len(side))
    while True:
        on_side, beside = (1.0, -inside / outside) if inside <= outside else (-outside / inside, 1.0)
        for i in range(len(side)):
            supply[i] = ncc * (on_side if side[i] else beside) * graph.volume[i]
        better = minimum_cut(network, supply)
        weight, inside, outside = cut_sums(graph, better)
        least = ncc_of(weight, inside, outside)
        if not least < ncc * (1 - LEAST_GAIN):
            return side
        side, ncc = better, least


def _ncc(cut: Cut) -> float:
    return cut.ncc
