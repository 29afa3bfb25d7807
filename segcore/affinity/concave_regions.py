"""The minima rule of Chahhou et al., section 4.2: which vertices lie in a concave region where a part may end.

The minimum curvature of every vertex is turned into a z-score; vertices below -0.8 are deep concave. Such regions are
wide, so they are thinned to paths by walks that start at the deepest vertex and step to the neighbour whose
surroundings are curved most alike; then what is short and shallow is cleaned away.

References
----------
Chahhou, Moumoun, El Far, Gadi, Segmentation of 3D meshes using p-spectral clustering, PAMI 2014, section 4.2.
"""

import numpy as np
from numba import njit

from segcore.affinity.curvature import PrincipalCurvatures
from segcore.arrays import BoolArray, FloatArray, IntArray
from segcore.graphs.surface_graph import Rows, connected_components
from segcore.parameters import Thinning

DEEP = -0.8  # z-score of the minimum curvature below which a vertex is deep concave
_SHORT = 3  # vertices: paths of fewer are insignificant ...
_DEEP_ENOUGH = -2.0  # ... unless one of their vertices is deeper than this z-score
_REGULARIZATION = 1e-6  # added to the diagonal of pooled covariances, as a share of the variance over the whole mesh


def z_scores(values: FloatArray) -> FloatArray:
    """(V,) values minus their mean, in standard deviations; all zero where the values are all equal."""
    spread = float(values.std())
    scores: FloatArray = (values - values.mean()) / spread if spread > 0 else np.zeros_like(values)
    return scores


def concave_vertices(curvatures: PrincipalCurvatures, rows: Rows, thinning: Thinning) -> BoolArray:
    """(V,) True for the vertices of concave regions where a part may end.

    Parameters
    ----------
    rows : the neighbours of every vertex along the edges of the mesh.
    thinning : ``"none"`` keeps every deep concave vertex. ``"walk"`` leaves each vertex once: the neighbour that the
        walk steps to stays concave, all others become non-concave. ``"revisit"`` lets the walk turn back, and only a
        vertex that is reached for the second time makes its other neighbours non-concave.
    """
    z = z_scores(curvatures.k2)
    concave = z < DEEP
    if thinning == "none":
        return concave
    mean, covariance = _region_statistics(curvatures.k1, curvatures.k2, rows.start, rows.neighbour)
    deepest_first = np.argsort(z, kind="stable")[: int(concave.sum())].astype(np.int32)
    thin = _walk if thinning == "walk" else _walk_with_revisits
    thinned = thin(deepest_first, concave, mean, covariance, rows.start, rows.neighbour)
    return cleaned_up(thinned, z, rows)


def cleaned_up(concave: BoolArray, z: FloatArray, rows: Rows) -> BoolArray:
    """Without the connected paths of fewer than 3 vertices that have no vertex deeper than -2."""
    owner = np.repeat(np.arange(len(concave), dtype=np.int32), np.diff(rows.start))
    inside = concave[owner] & concave[rows.neighbour] & (owner < rows.neighbour)
    pairs = np.stack([owner[inside], rows.neighbour[inside]], axis=1)
    path = connected_components(pairs, len(concave))
    length = np.bincount(path, concave)
    depth = np.full(len(length), np.inf)
    np.minimum.at(depth, path[concave], z[concave])
    kept: BoolArray = concave & ((length >= _SHORT) | (depth < _DEEP_ENOUGH))[path]
    return kept


@njit(cache=True)
def _region_statistics(
    k1: FloatArray, k2: FloatArray, start: IntArray, neighbour: IntArray
) -> tuple[FloatArray, FloatArray]:
    """Mean (V, 2) and covariance (V, 3: 11, 12, 22) of the columns of every 2 x (N + 1) curvature matrix."""
    count = len(k1)
    mean = np.zeros((count, 2))
    covariance = np.zeros((count, 3))
    floor1, floor2 = _REGULARIZATION * np.var(k1), _REGULARIZATION * np.var(k2)
    for v in range(count):
        size = start[v + 1] - start[v] + 1
        a, b = k1[v], k2[v]
        for p in range(start[v], start[v + 1]):
            a += k1[neighbour[p]]
            b += k2[neighbour[p]]
        mean[v, 0], mean[v, 1] = a / size, b / size
        xx, xy, yy = (k1[v] - mean[v, 0]) ** 2, (k1[v] - mean[v, 0]) * (k2[v] - mean[v, 1]), (k2[v] - mean[v, 1]) ** 2
        for p in range(start[v], start[v + 1]):
            x, y = k1[neighbour[p]] - mean[v, 0], k2[neighbour[p]] - mean[v, 1]
            xx += x * x
            xy += x * y
            yy += y * y
        covariance[v, 0], covariance[v, 1], covariance[v, 2] = xx / size + floor1, xy / size, yy / size + floor2
    return mean, covariance


@njit(cache=True)
def _mahalanobis(u: int, v: int, mean: FloatArray, covariance: FloatArray) -> float:
    """Squared Mahalanobis distance between the means of two regions under their pooled covariance."""
    x, y = mean[u, 0] - mean[v, 0], mean[u, 1] - mean[v, 1]
    a = 0.5 * (covariance[u, 0] + covariance[v, 0])
    b = 0.5 * (covariance[u, 1] + covariance[v, 1])
    c = 0.5 * (covariance[u, 2] + covariance[v, 2])
    determinant = a * c - b * b
    if determinant <= 0.0:
        return x * x + y * y
    return (c * x * x - 2.0 * b * x * y + a * y * y) / determinant


@njit(cache=True)
def _most_alike(
    here: int, open_: BoolArray, mean: FloatArray, covariance: FloatArray, start: IntArray, neighbour: IntArray
) -> int:
    """The open neighbour of a vertex with the least Mahalanobis distance; -1 where none is open."""
    ahead, nearest = -1, np.inf
    for p in range(start[here], start[here + 1]):
        v = neighbour[p]
        if open_[v]:
            distance = _mahalanobis(here, v, mean, covariance)
            if distance < nearest:
                ahead, nearest = v, distance
    return ahead


@njit(cache=True)
def _walk(
    deepest_first: IntArray,
    concave: BoolArray,
    mean: FloatArray,
    covariance: FloatArray,
    start: IntArray,
    neighbour: IntArray,
) -> BoolArray:
    """Paths in which every vertex has at most the neighbours before and after it."""
    open_ = concave.copy()
    path = np.zeros(len(concave), np.bool_)
    for seed in deepest_first:
        if not open_[seed]:
            continue
        here = seed
        while here != -1:
            path[here] = True
            open_[here] = False
            ahead = _most_alike(here, open_, mean, covariance, start, neighbour)
            for p in range(start[here], start[here + 1]):
                if neighbour[p] != ahead:
                    open_[neighbour[p]] = False
            here = ahead
    return path


@njit(cache=True)
def _walk_with_revisits(
    deepest_first: IntArray,
    concave: BoolArray,
    mean: FloatArray,
    covariance: FloatArray,
    start: IntArray,
    neighbour: IntArray,
) -> BoolArray:
    """Walks that may turn back; a vertex reached for the second time is taken out and merges its surroundings."""
    open_ = concave.copy()
    visits = np.zeros(len(concave), np.int32)
    path = np.zeros(len(concave), np.bool_)
    for seed in deepest_first:
        here = seed if open_[seed] else -1
        while here != -1:
            path[here] = True
            visits[here] += 1
            if visits[here] == 2:
                open_[here] = False
                for p in range(start[here], start[here + 1]):
                    if visits[neighbour[p]] == 0:
                        open_[neighbour[p]] = False
            here = _most_alike(here, open_, mean, covariance, start, neighbour)
    return path
