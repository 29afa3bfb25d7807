"""Cut, volume, normalized Cheeger cut, and the best threshold of a function on the nodes."""

from dataclasses import dataclass
from math import inf
from typing import Literal, TypeAlias

import numpy as np
from numba import njit

from segcore.arrays import BoolArray, FloatArray
from segcore.graphs.surface_graph import SurfaceGraph

_VALLEY = 0.03  # of the volume, to either side: half the least distance of two valleys; set by hand

Criterion: TypeAlias = Literal["ncc", "ncut"]


@dataclass(frozen=True, slots=True, eq=False)
class Cut:
    """A bipartition of the nodes of a graph, its weight and its volumes."""

    side: BoolArray  # (N,) True for the nodes of S
    weight: float  # cut(S, T): sum of the weights between the sides
    inside: float  # vol(S)
    outside: float  # vol(T)

    @property
    def ncc(self) -> float:
        """Normalized Cheeger cut, cut(S, T) / min(vol(S), vol(T)); infinity if a side is empty."""
        smaller = min(self.inside, self.outside)
        return self.weight / smaller if smaller > 0 else inf

    @property
    def ncut(self) -> float:
        """Normalized cut, cut(S, T) (1 / vol(S) + 1 / vol(T)); infinity if a side is empty."""
        if min(self.inside, self.outside) <= 0:
            return inf
        return self.weight / self.inside + self.weight / self.outside

    def value(self, criterion: Criterion) -> float:
        """Return the ratio that the criterion names."""
        return self.ncc if criterion == "ncc" else self.ncut

    @property
    def canonical(self) -> "Cut":
        """The same bipartition with node 0 in S, which makes equal bipartitions equal cuts."""
        return self if self.side[0] else Cut(~self.side, self.weight, self.outside, self.inside)

    @property
    def key(self) -> bytes:
        """Equal for two cuts of a graph if and only if they are the same bipartition."""
        return np.packbits(self.canonical.side).tobytes()


def cut_of(graph: SurfaceGraph, side: BoolArray) -> Cut:
    """Return the cut between a set of nodes and the rest.

    Parameters
    ----------
    side : (N,) True for the nodes of S.
    """
    crossing = side[graph.edges[:, 0]] != side[graph.edges[:, 1]]
    weight = graph.weight[crossing].sum()
    return Cut(side, float(weight), float(graph.volume[side].sum()), float(graph.volume[~side].sum()))


def cut_weight(graph: SurfaceGraph, side: BoolArray) -> float:
    """cut(S, T) = sum of W[i, j] over i in S and j not in S."""
    return cut_of(graph, side).weight


def ncc(graph: SurfaceGraph, side: BoolArray) -> float:
    """Normalized Cheeger cut of a bipartition.

    NCC(S, T) = cut(S, T) / min(vol(S), vol(T)), infinity if a side is empty.

    References
    ----------
    Buehler and Hein, Spectral clustering based on the graph p-Laplacian, ICML 2009, section 2.
    """
    return cut_of(graph, side).ncc


def ncut(graph: SurfaceGraph, side: BoolArray) -> float:
    """Normalized cut of a bipartition.

    NCut(S, T) = cut(S, T) (1 / vol(S) + 1 / vol(T)), infinity if a side is empty.

    References
    ----------
    Shi and Malik, Normalized cuts and image segmentation, PAMI 22(8), 2000.
    """
    return cut_of(graph, side).ncut


def balance_subgradient(graph: SurfaceGraph, cut: Cut) -> FloatArray:
    """(N,) vol[i] on the smaller side, -r vol[i] on the larger one, r = vol(smaller) / vol(larger); the sum is 0.

    At the indicator of the smaller side it is a subgradient of the balance B(f) = min over c of sum vol[i] |f[i] - c|.
    B is min(vol(A), vol(rest)) at the indicator of any set A, and the sum over A is at most that.
    """
    if cut.inside <= cut.outside:
        return np.where(cut.side, graph.volume, -cut.inside / cut.outside * graph.volume)
    return np.where(cut.side, -cut.outside / cut.inside * graph.volume, graph.volume)


def sweep(graph: SurfaceGraph, values: FloatArray, criterion: Criterion = "ncc") -> Cut:
    """Return the best cut among the upper level sets {i : values[i] > t} of a function. O(E + N log N).

    Nodes of equal value always stay together; of equally good thresholds the lowest one is taken.

    Parameters
    ----------
    values : (N,) finite.
    criterion : the ratio to minimise, the normalized Cheeger cut or the normalized cut.

    Returns
    -------
    The cut, whose ``side`` is the upper level set; it is empty (and both ratios are infinite) if all values are equal.
    """
    values = np.ascontiguousarray(values)
    order = np.argsort(values)
    threshold = _best_threshold(graph.edges, graph.weight, graph.volume, values, order, criterion == "ncut")
    return cut_of(graph, values > threshold)


def valleys(graph: SurfaceGraph, values: FloatArray, most: int) -> list[Cut]:
    """Return the cuts of least weight among the upper level sets of a function, each the least one around it.

    A cut through a neck is a valley of the weight along the sweep, even if another level set has a better ratio.

    Parameters
    ----------
    values : (N,) finite.
    most : number of valleys, at most.
    """
    order = np.argsort(values, kind="stable")
    found = _valleys(graph.edges, graph.weight, graph.volume, order, _VALLEY * graph.total_volume, most)
    above = np.arange(graph.node_count)[None, :] > found[:, None]
    sides = np.zeros((len(found), graph.node_count), dtype=bool)
    sides[:, order] = above
    return [cut_of(graph, side) for side in sides]


@njit(cache=True)
def _changes(edges, weight, order):  # type: ignore[no-untyped-def]
    """(N,) changes from rank to rank of the weight of the cut after it, which is their running sum.

    An edge between ranks a < b is cut by the thresholds after rank a, a + 1, ..., b - 1: its weight is added at a and
    subtracted at b.
    """
    node_count = len(order)
    rank = np.empty(node_count, dtype=np.int32)
    for r in range(node_count):
        rank[order[r]] = r
    change = np.zeros(node_count)
    for e in range(len(edges)):
        a = rank[edges[e, 0]]
        b = rank[edges[e, 1]]
        change[min(a, b)] += weight[e]
        change[max(a, b)] -= weight[e]
    return change


@njit(cache=True)
def _valleys(edges, weight, volume, order, width, most):  # type: ignore[no-untyped-def]
    """The ranks after which the weight of the cut is the least within a width of volume to both sides."""
    node_count = len(volume)
    below = np.cumsum(volume[order])
    cut = np.cumsum(_changes(edges, weight, order))
    found = np.empty(most, dtype=np.int64)
    count = 0
    first = last = 0
    for r in range(node_count - 1):
        while below[r] - below[first] > width:
            first += 1
        while last < node_count - 1 and below[last] - below[r] < width:
            last += 1
        if first == 0 or last == node_count - 1:
            continue
        lowest = True
        for q in range(first, last + 1):
            if cut[q] < cut[r] or (cut[q] == cut[r] and q < r):
                lowest = False
        if not lowest:
            continue
        k = count
        while k > 0 and cut[found[k - 1]] > cut[r]:
            if k < most:
                found[k] = found[k - 1]
            k -= 1
        if k < most:
            found[k] = r
            count = min(count + 1, most)
    return found[:count]


@njit(cache=True)
def _best_threshold(edges, weight, volume, values, order, both_sides):  # type: ignore[no-untyped-def]
    """The value whose upper level set has the least ratio."""
    node_count = len(volume)
    change = _changes(edges, weight, order)
    total = 0.0
    for i in range(node_count):
        total += volume[i]
    best_ratio = np.inf
    best_threshold = values[order[node_count - 1]]
    cut = 0.0
    below = 0.0
    for r in range(node_count - 1):
        cut += change[r]
        below += volume[order[r]]
        if values[order[r]] == values[order[r + 1]]:
            continue
        above = total - below
        ratio = cut / below + cut / above if both_sides else cut / min(below, above)
        if ratio < best_ratio:
            best_ratio = ratio
            best_threshold = values[order[r]]
    return best_threshold
