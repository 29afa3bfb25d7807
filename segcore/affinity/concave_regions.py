"""The minima rule of Chahhou et al., section 4.2: the vertices of concave regions at which a part may end.

The minimum curvature of every vertex is turned into a z-score; vertices below -0.8 are deep concave. Their regions are
wide and are thinned to paths: a walk starts at the deepest vertex and steps to the neighbour with the most similar
curvatures around it. Short and shallow paths are then removed.

References
----------
Chahhou, Moumoun, El Far, Gadi, Segmentation of 3D meshes using p-spectral clustering, PAMI 2014, section 4.2.
"""

from typing import NamedTuple

import numpy as np

from segcore.affinity.curvature import PrincipalCurvatures
from segcore.arrays import BoolArray, FloatArray, IntArray
from segcore.graphs.surface_graph import Rows, connected_components
from segcore.jit.decorators import inner_kernel, kernel
from segcore.parameters import Thinning

DEEP = -0.8  # z-score of the minimum curvature below which a vertex is deep concave: the paper's
# Readings of the paper, which removes "short" paths without a "deep" vertex: see docs/algorithm.md, section 7.
_SHORT = 3  # vertices: shorter paths are removed ...
_DEEP_ENOUGH = -2.0  # ... unless one of their vertices has a z-score below this
_REGULARIZATION = 1e-6  # added to the diagonal of covariances, as a share of the variance over the mesh; set by hand


class Regions(NamedTuple):
    """Statistics of the principal curvatures in the region of every vertex, which is the vertex and its 1-ring."""

    mean: FloatArray  # (V, 2) of k1 and k2
    covariance: FloatArray  # (V, 3) entries 11, 12, 22


def z_scores(values: FloatArray) -> FloatArray:
    """(V,) values minus their mean, in standard deviations; all zero if the values are equal."""
    spread = float(values.std())
    scores: FloatArray = (values - values.mean()) / spread if spread > 0 else np.zeros_like(values)
    return scores


def concave_vertices(curvatures: PrincipalCurvatures, rows: Rows, thinning: Thinning) -> BoolArray:
    """(V,) True for the vertices of concave regions at which a part may end.

    Parameters
    ----------
    rows : the neighbours of every vertex along the edges of the mesh.
    thinning : ``"none"`` keeps every deep concave vertex. ``"walk"`` visits a vertex once: the neighbour that the walk
        steps to stays concave, all others become non-concave. ``"revisit"`` lets the walk turn back; only a vertex that
        is reached for the second time makes its other neighbours non-concave.
    """
    z = z_scores(curvatures.k2)
    concave = z < DEEP
    if thinning == "none":
        return concave
    regions = region_statistics(curvatures.k1, curvatures.k2, rows)
    deepest_first = np.argsort(z, kind="stable")[: int(concave.sum())].astype(np.int32)
    thin = _walk if thinning == "walk" else _walk_with_revisits
    return cleaned_up(thin(deepest_first, concave, rows, regions), z, rows)


def cleaned_up(concave: BoolArray, z: FloatArray, rows: Rows) -> BoolArray:
    """(V,) concave vertices without the connected paths of fewer than 3 that have no z-score below -2."""
    owner = np.repeat(np.arange(len(concave), dtype=np.int32), np.diff(rows.start))
    inside = concave[owner] & concave[rows.neighbour] & (owner < rows.neighbour)
    path = connected_components(np.stack([owner[inside], rows.neighbour[inside]], axis=1), len(concave))
    length = np.bincount(path, concave)
    depth = np.full(len(length), np.inf)
    np.minimum.at(depth, path[concave], z[concave])
    kept: BoolArray = concave & ((length >= _SHORT) | (depth < _DEEP_ENOUGH))[path]
    return kept


@kernel
def region_statistics(k1: FloatArray, k2: FloatArray, rows: Rows) -> Regions:
    """Mean and covariance of the columns of the 2 x (N + 1) matrix of principal curvatures in every region."""
    start, neighbour = rows.start, rows.neighbour
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
    return Regions(mean, covariance)


@kernel
def mahalanobis(u: int, v: int, regions: Regions) -> float:
    """Squared Mahalanobis distance between the means of the regions of two vertices under their pooled covariance."""
    mean, covariance = regions.mean, regions.covariance
    x, y = mean[u, 0] - mean[v, 0], mean[u, 1] - mean[v, 1]
    a = 0.5 * (covariance[u, 0] + covariance[v, 0])
    b = 0.5 * (covariance[u, 1] + covariance[v, 1])
    c = 0.5 * (covariance[u, 2] + covariance[v, 2])
    determinant = a * c - b * b
    if determinant <= 0.0:
        return x * x + y * y
    return (c * x * x - 2.0 * b * x * y + a * y * y) / determinant


@inner_kernel
def _most_similar(here: int, is_open: BoolArray, rows: Rows, regions: Regions) -> int:
    """The open neighbour of a vertex with the least Mahalanobis distance; -1 if none is open."""
    ahead, nearest = -1, np.inf
    for p in range(rows.start[here], rows.start[here + 1]):
        v = rows.neighbour[p]
        if is_open[v]:
            distance = mahalanobis(here, v, regions)
            if distance < nearest:
                ahead, nearest = v, distance
    return ahead


@kernel
def _walk(deepest_first: IntArray, concave: BoolArray, rows: Rows, regions: Regions) -> BoolArray:
    """(V,) paths in which every vertex has at most the neighbours before and after it.

    Parameters
    ----------
    deepest_first : the concave vertices by ascending z-score.
    """
    is_open = concave.copy()
    path = np.zeros(len(concave), np.bool_)
    for seed in deepest_first:
        if not is_open[seed]:
            continue
        here = seed
        while here != -1:
            path[here] = True
            is_open[here] = False
            ahead = _most_similar(here, is_open, rows, regions)
            for p in range(rows.start[here], rows.start[here + 1]):
                if rows.neighbour[p] != ahead:
                    is_open[rows.neighbour[p]] = False
            here = ahead
    return path


@kernel
def _walk_with_revisits(deepest_first: IntArray, concave: BoolArray, rows: Rows, regions: Regions) -> BoolArray:
    """(V,) walks that may turn back. A vertex reached for the second time closes itself and its unvisited neighbours.

    Parameters
    ----------
    deepest_first : the concave vertices by ascending z-score.
    """
    is_open = concave.copy()
    visits = np.zeros(len(concave), np.int32)
    path = np.zeros(len(concave), np.bool_)
    for seed in deepest_first:
        here = seed if is_open[seed] else -1
        while here != -1:
            path[here] = True
            visits[here] += 1
            if visits[here] == 2:
                is_open[here] = False
                for p in range(rows.start[here], rows.start[here + 1]):
                    if visits[rows.neighbour[p]] == 0:
                        is_open[rows.neighbour[p]] = False
            here = _most_similar(here, is_open, rows, regions)
    return path
