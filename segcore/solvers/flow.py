"""Exact improvement of cuts by maximum flows: the default solver."""

from itertools import islice

from segcore.arrays import BoolArray
from segcore.graphs.cheeger import Cut, balance_subgradient, cut_of, sweep
from segcore.graphs.max_flow import Network
from segcore.graphs.surface_graph import SurfaceGraph
from segcore.solvers.fiedler import eigenvectors
from segcore.solvers.total_variation import TotalVariationFlow

STEPS = 4  # of total variation flow from every eigenvector
ITERATIONS = 5  # of split Bregman in a step
HOPELESS = 1.35  # times the best value so far: a cut that is worse is not improved
LEAST_GAIN = 1e-12  # relative: a smaller one is rounding


def flow_cut(graph: SurfaceGraph, *, count: int = 2) -> Cut:
    """A small normalized Cheeger cut: the best of several eigenvectors, each improved in two ways.

    A few steps of total variation flow leave the surroundings of the eigenvector's own cut; the best cut that they pass
    is then improved by maximum flows, exactly. Never worse than the sweep of the Fiedler vector.

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
        Where the graph is not connected.
    """
    network = Network.of(graph)
    vectors = eigenvectors(graph, network.factor, count).T
    flow = TotalVariationFlow.of(graph, vectors[0])
    passed = [min(islice(flow.cuts(values, ITERATIONS), STEPS + 1), key=_ncc) for values in vectors]
    different = {cut.key: cut for cut in passed}
    best, *others = sorted(different.values(), key=_ncc)
    best = _improved(network, best)
    promising = [cut for cut in others if cut.ncc <= HOPELESS * best.ncc]
    return min([best, *(_improved(network, cut) for cut in promising)], key=_ncc).canonical


def sweep_cuts(graph: SurfaceGraph, count: int = 3) -> list[Cut]:
    """The best of the sweeps of several eigenvectors, improved by maximum flows; then the sweeps as they are.

    Parameters
    ----------
    graph : connected, at least two nodes.
    count : how many eigenvectors after the constant one, at least 1.

    Raises
    ------
    ValueError
        Where the graph is not connected.
    """
    network = Network.of(graph)
    sweeps = [sweep(graph, values) for values in eigenvectors(graph, network.factor, count).T]
    return [cut.canonical for cut in (_improved(network, min(sweeps, key=_ncc)), *sweeps)]


def improve(graph: SurfaceGraph, side: BoolArray) -> Cut:
    """Lower the normalized Cheeger cut of a bipartition by maximum flows until none of them lowers it any more.

    With S the smaller side, r = vol(S) / vol(T) and q = NCC(S), a flow finds the set A of least

        cut(A) - q (vol(A and S) - r vol(A without S)).

    What is subtracted is at most q min(vol(A), vol(rest)), so that a negative value means that NCC(A) < q, and A takes
    the place of S. In the end no set is better in this sense; in particular no subset of S is.

    Parameters
    ----------
    graph : connected.
    side : (N,) neither empty nor full.

    References
    ----------
    Andersen and Lang, An algorithm for improving graph partitions, SODA 2008; Hein and Setzer, Beyond spectral
    clustering: tight relaxations of balanced graph cuts, NIPS 2011.
    """
    return _improved(Network.of(graph), cut_of(graph, side))


def _improved(network: Network, cut: Cut) -> Cut:
    while True:
        supply = cut.ncc * balance_subgradient(network.graph, cut)
        better = cut_of(network.graph, network.minimum_cut(supply))
        if not better.ncc < cut.ncc * (1 - LEAST_GAIN):
            return cut
        cut = better


def _ncc(cut: Cut) -> float:
    return cut.ncc
