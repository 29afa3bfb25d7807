"""Cut, volume, normalized Cheeger cut, and the best threshold of a function on the nodes."""

from dataclasses import dataclass
from math import inf
from typing import Literal, NamedTuple, TypeAlias

import numpy as np

from segcore.array_kernels import ascending
from segcore.arrays import BoolArray, FloatArray, IntArray
from segcore.graphs.surface_graph import SurfaceGraph
from segcore.jit.decorators import inner_kernel, kernel

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
    return Cut(side, *cut_sums(graph, side))


@kernel
def cut_sums(graph: SurfaceGraph, side: BoolArray) -> tuple[float, float, float]:
    """Weight of the cut between a set of nodes (N,) and the rest, volume of the set, and volume of the rest."""
    weight = 0.0
    for e in range(len(graph.edges)):
        if side[graph.edges[e, 0]] != side[graph.edges[e, 1]]:
            weight += graph.weight[e]
    inside, outside = side_volumes(graph.volume, side)
    return weight, inside, outside


@inner_kernel
def side_volumes(volume: FloatArray, side: BoolArray) -> tuple[float, float]:
    """Volume of a set of nodes (N,), and of the rest."""
    inside = outside = 0.0
    for i in range(len(side)):
        if side[i]:
            inside += volume[i]
        else:
            outside += volume[i]
    return inside, outside


@inner_kernel
def ncc_of(weight: float, inside: float, outside: float) -> float:
    """Normalized Cheeger cut of a cut with these sums; infinity if a side is empty."""
    smaller = min(inside, outside)
    return weight / smaller if smaller > 0.0 else np.inf


@inner_kernel
def distinct_cuts(sides: BoolArray) -> BoolArray:
    """(K, N) the different bipartitions among some sides (C, N), in their order, node 0 on each side."""
    kept = np.empty_like(sides)
    count = 0
    for side in sides:
        is_new = True
        for k in range(count):
            is_new = is_new and not _are_equal(side, kept[k])
        if is_new:
            for i in range(len(side)):
                kept[count, i] = side[i] == side[0]
            count += 1
    return kept[:count]


@inner_kernel
def _are_equal(side: BoolArray, canonical: BoolArray) -> bool:
    """Whether two sets are the same bipartition; node 0 is in the second."""
    is_equal = True
    for i in range(len(side)):
        is_equal = is_equal and (side[i] == side[0]) == canonical[i]
    return is_equal


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
    """Return the best cut among the upper level sets {i : values[i] > t} of a function. O(E + N).

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
    return cut_of(graph, best_level_set(values, level_sets(graph, values), criterion == "ncut"))


class LevelSets(NamedTuple):
    """The nodes by increasing values of a function, and the cuts between the first r + 1 of them and the rest."""

    order: IntArray  # (N,)
    weight: FloatArray  # (N,)
    volume: FloatArray  # (N,) of the first r + 1 nodes


@kernel
def level_sets(graph: SurfaceGraph, values: FloatArray) -> LevelSets:
    """The level sets of a function (N,) on the nodes.

    An edge between ranks a < b is cut after rank a, a + 1, ..., b - 1: its weight is added at a and subtracted at b.
    """
    order = ascending(values)
    node_count = len(order)
    rank = np.empty(node_count, dtype=np.int32)
    for r in range(node_count):
        rank[order[r]] = r
    weight = np.zeros(node_count)
    for e in range(len(graph.edges)):
        a, b = rank[graph.edges[e, 0]], rank[graph.edges[e, 1]]
        weight[min(a, b)] += graph.weight[e]
        weight[max(a, b)] -= graph.weight[e]
    volume = np.empty(node_count)
    cut, below = 0.0, 0.0
    for r in range(node_count):
        cut += weight[r]
        below += graph.volume[order[r]]
        weight[r], volume[r] = cut, below
    return LevelSets(order, weight, volume)


@kernel
def best_level_set(values: FloatArray, levels: LevelSets, both_sides: bool) -> BoolArray:
    """(N,) the upper level set of the least normalized cut, or of the least normalized Cheeger cut."""
    node_count = len(values)
    total = levels.volume[node_count - 1]
    best_ratio = np.inf
    best_rank = node_count - 1
    for r in range(node_count - 1):
        if values[levels.order[r]] == values[levels.order[r + 1]]:
            continue
        cut, below, above = levels.weight[r], levels.volume[r], total - levels.volume[r]
        ratio = cut / below + cut / above if both_sides else cut / min(below, above)
        if ratio < best_ratio:
            best_ratio, best_rank = ratio, r
    side = np.zeros(node_count, dtype=np.bool_)
    _add_after(side, levels, best_rank)
    return side


@kernel
def valley_sides(levels: LevelSets, most: int) -> BoolArray:
    """(K, N) the upper level sets whose weight is the least within a width of volume to both sides, K <= most.

    A cut through a neck is such a valley, even if another level set has a better ratio. The least one comes first. A
    window over the ranks is moved along; ``queue`` has the ranks in it that are lower than all later ones, so that the
    first is the lowest (Lemire, Streaming maximum-minimum filter using no more than three comparisons per element,
    Nordic Journal of Computing 13, 2006).
    """
    weight, volume = levels.weight, levels.volume
    node_count = len(weight)
    width = _VALLEY * volume[node_count - 1]
    found = np.empty(most, dtype=np.int64)
    queue = np.empty(node_count, dtype=np.int32)
    count = first = head = tail = 0
    last = -1
    for r in range(node_count - 1):
        while volume[r] - volume[first] > width:
            first += 1
        while last < node_count - 1 and (last < r or volume[last] - volume[r] < width):
            last += 1
            while tail > head and weight[queue[tail - 1]] > weight[last]:
                tail -= 1
            queue[tail] = last
            tail += 1
        while queue[head] < first:
            head += 1
        if first == 0 or last == node_count - 1 or queue[head] != r:
            continue
        k = count
        while k > 0 and weight[found[k - 1]] > weight[r]:
            if k < most:
                found[k] = found[k - 1]
            k -= 1
        if k < most:
            found[k] = r
            count = min(count + 1, most)
    sides = np.zeros((count, node_count), dtype=np.bool_)
    for k in range(count):
        _add_after(sides[k], levels, found[k])
    return sides


@inner_kernel
def _add_after(side: BoolArray, levels: LevelSets, rank: int) -> None:
    for r in range(rank + 1, len(levels.order)):
        side[levels.order[r]] = True
