"""Meshes of several components: the largest ones, the nearest to each other, and groups of near ones."""

import numpy as np
from scipy.cluster.hierarchy import linkage
from scipy.spatial import KDTree
from scipy.spatial.distance import cdist, squareform

from segcore.arrays import BoolArray, FloatArray, IntArray, group_sums

_SAMPLES = 2048  # points that represent all components when their distances are measured


def largest(component: IntArray, areas: FloatArray, most: int, negligible: float = 0.0) -> BoolArray:
    """(C,): True for the ``most`` largest components, without those that are negligible.

    Parameters
    ----------
    component : (P,) the component 0..C - 1 of every point, face or node.
    areas : (P,)
    negligible : share of the total area; a component with a tenth of the largest one's area is never negligible.
    """
    area = group_sums(component, areas)
    chosen = np.zeros(len(area), dtype=bool)
    chosen[np.argsort(-area, kind="stable")[:most]] = True
    return chosen & (area >= min(negligible * area.sum(), 0.1 * area.max()))


def nearest_hosts(component: IntArray, is_host: BoolArray, points: FloatArray) -> IntArray:
    """(N, 2): for every component that is not a host the point of it that is nearest to any host, and that one's point.

    Parameters
    ----------
    component : (P,) the component of every point.
    is_host : (C,), True somewhere.
    points : (P, 3)
    """
    follows = ~is_host[component]
    own, hosts = np.flatnonzero(follows), np.flatnonzero(~follows)
    if len(own) == 0:
        return np.empty((0, 2), dtype=np.int32)
    distance, nearest = map(np.asarray, KDTree(points[hosts]).query(points[own]))
    order = np.lexsort((distance, component[own]))
    first = np.unique(component[own][order], return_index=True)[1]
    return np.stack([own[order[first]], hosts[nearest[order[first]]]], axis=1).astype(np.int32)


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
    distance = cdist(points[sample], points[sample])
    nearest = np.minimum.reduceat(np.minimum.reduceat(distance, start, axis=0), start, axis=1)
    np.fill_diagonal(nearest, 0.0)
    return linkage(squareform(nearest, checks=False), "single")[:, :2].astype(np.int32)


def _sample(component: IntArray, count: int) -> tuple[IntArray, IntArray]:
    """Evenly strided points of every component, grouped by component, and where each group starts."""
    order = np.argsort(component, kind="stable")
    size = np.bincount(component, minlength=count)
    first = np.cumsum(size) - size
    taken = np.minimum(size, max(1, _SAMPLES // count))
    start = np.cumsum(taken) - taken
    within = np.arange(taken.sum()) - np.repeat(start, taken)
    stride = np.repeat(size / taken, taken)
    sample = order[np.repeat(first, taken) + (within * stride).astype(np.int64)]
    return sample.astype(np.int32), start.astype(np.int32)
