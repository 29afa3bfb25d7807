"""Improvement of cuts by maximum flows: the default solver."""

from itertools import islice

from segcore.graphs.cheeger import Cut, balance_subgradient, cut_of, sweep, valleys
from segcore.graphs.max_flow import Network
from segcore.graphs.surface_graph import SurfaceGraph
from segcore.solvers.fiedler import eigenvectors
from segcore.solvers.total_variation import TotalVariationFlow

# Set by hand. The first three are compared with their neighbours in bench/RESULTS.md, "Constants and their neighbours".
STEPS = 4  # of total variation flow from every eigenvector
ITERATIONS = 5  # of split Bregman in a step
WORST_IMPROVED = 1.35  # times the best value so far: cuts with a larger one are not improved
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


def sweep_cuts(graph: SurfaceGraph, count: int = 3) -> list[Cut]:
    """Return the best of the sweeps of several eigenvectors, improved by maximum flows, the sweeps, and their valleys.

    Parameters
    ----------
    graph : connected, at least two nodes.
    count : how many eigenvectors after the constant one, at least 1.

    Raises
    ------
    ValueError
        If the graph is not connected.
    """
    network = Network.of(graph)
    vectors = eigenvectors(graph, network.factor, count).T
    sweeps = [sweep(graph, values) for values in vectors]
    necks = [cut for values in vectors for cut in valleys(graph, values, VALLEYS)]
    return [cut.canonical for cut in (improve(network, min(sweeps, key=_ncc)), *sweeps, *necks)]


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
    while True:
        supply = cut.ncc * balance_subgradient(network.graph, cut)
        better = cut_of(network.graph, network.minimum_cut(supply))
        if not better.ncc < cut.ncc * (1 - LEAST_GAIN):
            return cut
        cut = better


def _ncc(cut: Cut) -> float:
    return cut.ncc
