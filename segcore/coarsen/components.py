"""Components of a mesh: the largest ones, the nearest to each other, and groups by distance."""

import numpy as np
from scipy.cluster.hierarchy import linkage
from scipy.spatial import KDTree
from scipy.spatial.distance import cdist, squareform

from segcore.arrays import BoolArray, FloatArray, IntArray, group_sums
from segcore.jit.decorators import kernel

_SAMPLES = 2048  # points that represent all components in the matrix of distances: 34 MB
_NEVER_NEGLIGIBLE = 0.1  # share of the area of the largest component; set by hand


def largest(component: IntArray, areas: FloatArray, most: int, negligible: float = 0.0) -> BoolArray:
    """(C,) True for the ``most`` largest components, without negligible ones.

    Parameters
    ----------
    component : (P,) the component 0..C - 1 of every point, face or node.
    areas : (P,)
    negligible : share of the total area below which a component is negligible, unless it has a tenth of the area of the
        largest one.
    """
    area = group_sums(component, areas)
    chosen = np.zeros(len(area), dtype=bool)
    chosen[np.argsort(-area, kind="stable")[:most]] = True
    return chosen & (area >= min(negligible * area.sum(), _NEVER_NEGLIGIBLE * area.max()))


def nearest_hosts(component: IntArray, is_host: BoolArray, points: FloatArray) -> IntArray:
    """(N, 2) for every component that is not a host its point that is nearest to a host, and that host's point.

    Parameters
    ----------
    component : (P,) the component of every point.
    is_host : (C,) True for the components that others are attached to; at least one.
    points : (P, 3)
    """
    is_other = ~is_host[component]
    others, hosts = np.flatnonzero(is_other), np.flatnonzero(~is_other)
    if len(others) == 0:
        return np.empty((0, 2), dtype=np.int32)
    distance, nearest = map(np.asarray, KDTree(points[hosts]).query(points[others]))
    order = np.lexsort((distance, component[others]))
    first = np.unique(component[others][order], return_index=True)[1]
    return np.stack([others[order[first]], hosts[nearest[order[first]]]], axis=1).astype(np.int32)


def group_by_nearness(points: FloatArray, component: IntArray) -> IntArray:
    """Single-linkage grouping of components by the least distance between sampled points.

    Parameters
    ----------
    points : (P, 3), at least one for every component.
    component : (P,) the component 0..C - 1 of every point.

    Returns
    -------
    (C - 1, 2) pairs of groups, the nearest first; groups 0..C - 1 are the components, merge i makes group C + i.
    """
    count = int(component.max()) + 1
    if count == 1:
        return np.empty((0, 2), dtype=np.int32)
    sample, start = _sample(component, count)
    if count > _SAMPLES:  # one point each
        return _merges(*_spanning_tree(points[sample]))
    distance = cdist(points[sample], points[sample])
    nearest = np.minimum.reduceat(np.minimum.reduceat(distance, start, axis=0), start, axis=1)
    np.fill_diagonal(nearest, 0.0)
    return linkage(squareform(nearest, checks=False), "single")[:, :2].astype(np.int32)


def _sample(component: IntArray, count: int) -> tuple[IntArray, IntArray]:
    """Evenly strided points of every component, grouped by component, and the first one of each group."""
    order = np.argsort(component, kind="stable")
    size = np.bincount(component, minlength=count)
    first = np.cumsum(size) - size
    taken = np.minimum(size, max(1, _SAMPLES // count))
    start = np.cumsum(taken) - taken
    within = np.arange(taken.sum()) - np.repeat(start, taken)
    stride = np.repeat(size / taken, taken)
    sample = order[np.repeat(first, taken) + (within * stride).astype(np.int64)]
    return sample.astype(np.int32), start.astype(np.int32)


@kernel
def _spanning_tree(points):  # type: ignore[no-untyped-def]
    """The edges (P - 1, 2) of a minimum spanning tree of points, and their squared lengths, by Prim's algorithm."""
    count = len(points)
    edges = np.empty((count - 1, 2), dtype=np.int32)
    squared = np.empty(count - 1)
    waiting = np.arange(1, count).astype(np.int32)
    nearest = np.zeros(count, dtype=np.int32)
    distance = np.full(count, np.inf)
    added = 0
    for step in range(count - 1):
        left = count - 1 - step
        best = 0
        for k in range(left):
            i = waiting[k]
            away = 0.0
            for axis in range(points.shape[1]):
                away += (points[i, axis] - points[added, axis]) ** 2
            if away < distance[i]:
                distance[i], nearest[i] = away, added
            if distance[i] < distance[waiting[best]]:
                best = k
        added = waiting[best]
        waiting[best] = waiting[left - 1]
        edges[step, 0], edges[step, 1], squared[step] = nearest[added], added, distance[added]
    return edges, squared


def _merges(edges: IntArray, length: FloatArray) -> IntArray:
    """(C - 1, 2) the groups that the edges of a tree of C components merge, the shortest edge first."""
    merges = np.empty_like(edges)
    group = list(range(2 * len(edges) + 1))  # a group that has the group, itself if it is not merged yet
    for i, edge in enumerate(np.argsort(length, kind="stable").tolist()):
        for side in range(2):
            at = int(edges[edge, side])
            while group[at] != at:
                group[at] = group[group[at]]
                at = group[at]
            merges[i, side] = at
            group[at] = len(edges) + 1 + i
    return merges
