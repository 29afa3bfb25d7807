"""Exact improvement of cuts by maximum flows: the default solver."""

from bisect import insort
from collections.abc import Iterator
from math import inf

from segcore.arrays import BoolArray, FloatArray
from segcore.cheeger import Cut, balance_subgradient, cut_of, sweep
from segcore.fiedler import eigenvectors
from segcore.graph import SurfaceGraph
from segcore.max_flow import Network

LEAST_GAIN = 1e-12  # relative: a smaller one is rounding
TILT = 0.4  # of the first eigenvector towards a later one
HOPELESS = 1.35  # times the best value so far: a swept cut that is worse is not improved
MIXED = 3  # cuts that the best one is mixed with


def flow_cut(graph: SurfaceGraph, *, count: int = 4) -> Cut:
    """A small normalized Cheeger cut: the best of several eigenvectors, swept and improved by maximum flows.

    The candidates are the eigenvectors, the first of them tilted towards every other one, and mixtures of the best cuts
    found. Never worse than the sweep of the Fiedler vector.

    Parameters
    ----------
    graph : connected, at least two nodes.
    count : how many eigenvectors after the constant one, at least 1; with 1, the Fiedler vector is the only candidate.

    Raises
    ------
    ValueError
        Where the graph is not connected.
    """
    network = Network.of(graph)
    contest = Contest(network)
    vectors = eigenvectors(graph, network.factor, count)
    for cut in sorted((sweep(graph, values) for values in _tilted(vectors)), key=_ncc):
        contest.enter(cut)
    if count > 1:
        for other in contest.found[:MIXED]:
            contest.enter(sweep(graph, _mixture(network, contest.found[0], other)))
    return contest.found[0]


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
    *_, cut = _descent(Network.of(graph), cut_of(graph, side))
    return cut


class Contest:
    """Cuts that are improved in turn, each as long as every step makes it the best one."""

    def __init__(self, network: Network) -> None:
        self.network = network
        self.found: list[Cut] = []  # best first
        self._seen: set[bytes] = set()

    def enter(self, cut: Cut) -> None:
        """Improve a cut that is promising and new, and put it in its place among those found."""
        best = self.found[0].ncc if self.found else inf
        if cut.ncc > HOPELESS * best:
            return
        for step, improved in enumerate(_descent(self.network, cut)):
            if improved.key in self._seen:
                return
            self._seen.add(improved.key)
            cut = improved
            if step > 0 and cut.ncc > best:
                break
        insort(self.found, cut, key=_ncc)


def _descent(network: Network, cut: Cut) -> Iterator[Cut]:
    """A cut, what a maximum flow makes of it, and so on, as long as the value falls."""
    previous = inf
    while cut.ncc < previous * (1 - LEAST_GAIN):
        yield cut
        previous = cut.ncc
        cut = cut_of(network.graph, network.minimum_cut(cut.ncc * balance_subgradient(network.graph, cut)))


def _tilted(vectors: FloatArray) -> Iterator[FloatArray]:
    yield from vectors.T
    for other in vectors.T[1:]:
        yield vectors[:, 0] + TILT * other
        yield vectors[:, 0] - TILT * other


def _mixture(network: Network, cut: Cut, other: Cut) -> FloatArray:
    """One step of the inverse iteration L f' = D f from two cuts at once: f is their sum."""
    supply = balance_subgradient(network.graph, cut)
    second = balance_subgradient(network.graph, other)
    return network.factor.solve(supply + second if supply @ second > 0 else supply - second)


def _ncc(cut: Cut) -> float:
    return cut.ncc
