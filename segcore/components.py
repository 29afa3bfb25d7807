"""Meshes of several components: which ones stand for themselves, and how near they are to each other."""

import numpy as np
from scipy.cluster.hierarchy import linkage
from scipy.spatial import KDTree
from scipy.spatial.distance import cdist, squareform

from segcore.arrays import FloatArray, IntArray, group_sums

_MOST_HOSTS = 1024  # components that can be told apart
_SMALLEST_HOST = 0.002  # share of the total area below which a component among many follows its neighbour
_SAMPLES = 2048  # points that represent all components when their distances are measured


def follow_hosts(component: IntArray, areas: FloatArray, centroids: FloatArray, most: int) -> tuple[IntArray, IntArray]:
    """Let the smallest of very many components follow larger ones.

    Up to ``most`` components all stand for themselves. Of more, the largest ``most`` that have at least 0.2 % of the
    total area do (the largest one always); every other one follows, as a whole, the face of those that is nearest to
    any of its own.

    Parameters
    ----------
    component : (F,) the component of every face.
    areas, centroids : (F,) and (F, 3) of the faces.

    Returns
    -------
    The faces that stand for themselves, ascending, and (F,) for every face the position among them of the one it
    follows.
    """
    area = group_sums(component, areas)
    if len(area) <= min(most, _MOST_HOSTS):
        everyone = np.arange(len(component), dtype=np.int32)
        return everyone, everyone
    largest = np.argsort(-area, kind="stable")[: min(most, _MOST_HOSTS)]
    hosts = largest[area[largest] >= min(_SMALLEST_HOST * area.sum(), area.max())]
    is_host = np.isin(component, hosts)
    host_faces = np.flatnonzero(is_host).astype(np.int32)
    followed = (np.cumsum(is_host) - 1).astype(np.int32)
    followers = component[~is_host]
    distance, nearest = map(np.asarray, KDTree(centroids[host_faces]).query(centroids[~is_host]))
    order = np.lexsort((distance, followers))
    different, first = np.unique(followers[order], return_index=True)
    followed[~is_host] = nearest[order][first][np.searchsorted(different, followers)]
    return host_faces, followed


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
