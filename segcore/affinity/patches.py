"""A surface as about 2,000 small patches, on which slowly varying quantities are measured and smoothed.

The number of patches does not grow with the mesh, and with it the cost of rays, smoothing and gradients.
"""

from dataclasses import dataclass

import numpy as np
from numba import njit

from segcore.arrays import FloatArray, IntArray, LongArray, at_least, group_sums
from segcore.clean.surface import Surface
from segcore.coarsen.grains import grains_of
from segcore.coarsen.matching import coarsen
from segcore.graphs.laplacian import Elimination
from segcore.graphs.surface_graph import SurfaceGraph
from segcore.threads import sums_of_blocks

COUNT = 2000  # of patches; set by hand
# Patches of a surface have about six neighbours. If they have more than _MOST_NEIGHBOURS on average, because edges have
# many faces, the graph has no small separators, and only _FEW patches are made; set by hand.
_MOST_NEIGHBOURS, _FEW = 32, 250
_LARGEST_SHARE = 1.5  # largest patch in mean areas: patches of similar size; set by hand
_SMALLEST_FACE = 1e-4  # least area of a face in mean areas, as in affinity/mesh_graphs.py
_SHORTEST_STEP = 0.1  # least distance of two centres, in the square root of the mean area of a patch; set by hand
_FLAT = 1e-3  # of a squared mean distance: keeps gradients of patches with few neighbours finite; set by hand


@dataclass(frozen=True, slots=True, eq=False)
class Patches:
    """Connected patches of faces, a finite volume discretisation of the surface."""

    of_face: IntArray  # (F,) the patch of every face
    grain: IntArray | None  # (F,) the groups of faces that the patches were made from, if the mesh is fine
    area: FloatArray  # (P,)
    centre: FloatArray  # (P, 3) centroids
    normal: FloatArray  # (P, 3) mean normals, of length 1 or 0
    pairs: IntArray  # (Q, 2) neighbouring patches
    border: FloatArray  # (Q,) length of their common border
    distance: FloatArray  # (Q,) between their centres
    smoothing: Elimination  # of the patches and one more node, to which every patch is joined

    def smoothed(self, values: FloatArray, radius: float, mass: FloatArray) -> FloatArray:
        """Values after an implicit step of diffusion, (I - radius^2 / 6 Laplace) x = values.

        The matrix is a Laplacian without the row of one more node, to which every patch is joined with its mass. The
        elimination of that graph subtracts nothing and so loses no mass, however small.

        Parameters
        ----------
        values : (P,) or (P, C) means over the patches.
        radius : in units of the surface.
        mass : (P,) > 0, weight of each value, at most the area. Patches of little mass take the values of their
            neighbours; with the areas as mass the smoothing keeps the mean.
        """
        exchange = radius**2 / 6 * self.border / self.distance
        factor = self.smoothing.factorise(np.concatenate([exchange, mass]))
        sources = (values.T * mass).reshape(-1, len(mass))
        solved = np.stack([factor.solve(np.append(source, -source.sum())) for source in sources], axis=-1)
        smooth: FloatArray = (solved[:-1] - solved[-1]).reshape(values.shape)
        return smooth

    def gradients(self, values: FloatArray) -> FloatArray:
        """(P, 3) the gradient of values (P,) in the tangent plane of every patch, by least squares over neighbours."""
        gradient = np.zeros((len(self.area), 3))
        joined, place = np.unique(self.pairs, return_inverse=True)  # the others have no neighbours
        gradient[joined] = _gradients(
            place.reshape(-1, 2), self.border / self.distance, self.centre[joined], self.normal[joined], values[joined]
        )
        return gradient


def _gradients(
    pairs: LongArray, weight: FloatArray, centre: FloatArray, normal: FloatArray, values: FloatArray
) -> FloatArray:
    count = len(centre)
    here, there = np.concatenate([pairs, pairs[:, ::-1]]).T
    weight = np.tile(weight, 2)
    step = centre[there] - centre[here]
    step -= np.einsum("ij,ij->i", step, normal[here])[:, None] * normal[here]
    rise = weight * (values[there] - values[here])
    moment = np.empty((count, 3, 3))
    right = np.empty((count, 3))
    for i in range(3):
        right[:, i] = group_sums(here, rise * step[:, i], count)
        for j in range(i, 3):
            moment[:, i, j] = moment[:, j, i] = group_sums(here, weight * step[:, i] * step[:, j], count)
    size = np.trace(moment, axis1=1, axis2=2)
    safe = _FLAT * size + np.finfo(float).tiny
    moment += safe[:, None, None] * np.eye(3)
    # Along the normal there is nothing to fit; any positive number there keeps the system regular.
    moment += size[:, None, None] * np.einsum("ki,kj->kij", normal, normal)
    gradient: FloatArray = np.linalg.solve(moment, right[:, :, None])[:, :, 0].astype(np.float64, copy=False)
    return gradient


def patches_of(surface: Surface, affinity: FloatArray, length: FloatArray, rng: np.random.Generator) -> Patches:
    """Divide a surface into about 2,000 patches of similar area that end at strong concavities.

    Parameters
    ----------
    affinity : (E,) in (0, 1], low where a patch should end.
    length : (E,) positive length of the mesh edge that every dual edge crosses.
    """
    areas = at_least(surface.areas, _SMALLEST_FACE)
    graph = SurfaceGraph(surface.edge_faces, length * affinity, areas, length)
    grain = grains_of(graph)
    coarse, of_face = coarsen(graph, COUNT, rng, largest_share=_LARGEST_SHARE, grain=grain)
    if 2 * len(coarse.edges) > _MOST_NEIGHBOURS * coarse.node_count:
        coarse, of_face = coarsen(graph, _FEW, rng, largest_share=_LARGEST_SHARE, grain=grain)
    count = coarse.node_count
    arrays = of_face, areas, surface.vertices, surface.faces, surface.normals, count
    sums = sums_of_blocks(_centres_and_normals, len(areas), *arrays, groups=count)
    centre, normal = sums[:, :3] / coarse.volume[:, None], sums[:, 3:]
    size = np.linalg.norm(normal, axis=1, keepdims=True)
    normal = np.divide(normal, size, out=np.zeros_like(normal), where=size > 0)
    distance = np.linalg.norm(centre[coarse.edges[:, 1]] - centre[coarse.edges[:, 0]], axis=1)
    least = _SHORTEST_STEP * np.sqrt(coarse.total_volume / count)
    distance = np.maximum(distance, least)
    smoothing = _smoothing(coarse.edges, count)
    return Patches(of_face, grain, coarse.volume, centre, normal, coarse.edges, coarse.length, distance, smoothing)


def _smoothing(pairs: IntArray, count: int) -> Elimination:
    """The elimination of the graph of patches with one more node next to all of them."""
    spokes = np.stack([np.arange(count), np.full(count, count)], axis=1).astype(np.int32)
    return Elimination.of(np.concatenate([pairs, spokes]), count + 1)


@njit(cache=True, nogil=True)
def _centres_and_normals(start, end, group, weight, vertices, faces, normals, count):  # type: ignore[no-untyped-def]
    """(count, 6) the weighted sums of the centroids and the normals of some faces over groups."""
    sums = np.zeros((count, 6))
    for f in range(start, end):
        a, b, c = vertices[faces[f, 0]], vertices[faces[f, 1]], vertices[faces[f, 2]]
        row = sums[group[f]]
        for axis in range(3):
            row[axis] += weight[f] * ((a[axis] + b[axis] + c[axis]) / 3.0)
            row[3 + axis] += weight[f] * normals[f, axis]
    return sums
