"""A surface as about 2,000 small patches, on which slowly varying quantities are measured and smoothed.

The number of patches does not grow with the mesh, and with it the cost of rays, smoothing and gradients.
"""

from dataclasses import dataclass

import numpy as np

from segcore.arrays import FloatArray, IntArray, at_least
from segcore.clean.surface import Surface
from segcore.coarsen.grains import grains_of
from segcore.coarsen.matching import coarsen
from segcore.graphs.laplacian import Elimination
from segcore.graphs.surface_graph import SurfaceGraph
from segcore.jit.decorators import inner_kernel, kernel
from segcore.threads import sums_of_blocks

COUNT = 2000  # of patches; set by hand
# Patches of a surface have about six neighbours. If they have more than _MOST_NEIGHBOURS on average, because edges have
# many faces, the graph has no small separators, and only _FEW patches are made; set by hand.
_MOST_NEIGHBOURS, _FEW = 32, 250
_LARGEST_SHARE = 1.5  # largest patch in mean areas: patches of similar size; set by hand
_SMALLEST_FACE = 1e-4  # least area of a face in mean areas, as in affinity/mesh_graphs.py
_SHORTEST_STEP = 0.1  # least distance of two centres, in the square root of the mean area of a patch; set by hand
_ROW, _COLUMN = (0, 0, 0, 1, 1, 2), (0, 1, 2, 1, 2, 2)  # of the six entries of a symmetric matrix
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
        return _gradients(self.pairs, self.border / self.distance, self.centre, self.normal, values)


@kernel
def _gradients(
    pairs: IntArray, weight: FloatArray, centre: FloatArray, normal: FloatArray, values: FloatArray
) -> FloatArray:
    """``Patches.gradients``; 0 for patches without neighbours."""
    count = len(centre)
    moment, right = np.zeros((count, 6)), np.zeros((count, 3))
    step = np.empty(3)
    for q in range(len(pairs)):
        rise = values[pairs[q, 1]] - values[pairs[q, 0]]
        for end in range(2):
            here = pairs[q, end]
            out = 0.0
            for k in range(3):
                step[k] = centre[pairs[q, 1], k] - centre[pairs[q, 0], k]
                out += step[k] * normal[here, k]
            for k in range(3):
                step[k] -= out * normal[here, k]
                right[here, k] += weight[q] * rise * step[k]
            for k in range(6):
                moment[here, k] += weight[q] * step[_ROW[k]] * step[_COLUMN[k]]
    gradient = np.zeros((count, 3))
    for i in range(count):
        size = moment[i, 0] + moment[i, 3] + moment[i, 5]
        if size > 0.0:
            # Along the normal there is nothing to fit; any positive number there keeps the system regular.
            for k in range(6):
                moment[i, k] = moment[i, k] / size + normal[i, _ROW[k]] * normal[i, _COLUMN[k]]
            for k in (0, 3, 5):
                moment[i, k] += _FLAT
            for k in range(3):
                right[i, k] /= size
            _solve(moment[i], right[i], gradient[i])
    return gradient


@inner_kernel
def _solve(matrix: FloatArray, right: FloatArray, solution: FloatArray) -> None:
    """Solve a symmetric positive definite 3 x 3 system by its adjugate: xx, xy, xz, yy, yz, zz."""
    a, b, c, d, e, f = matrix
    adjugate = (d * f - e * e, c * e - b * f, b * e - c * d, a * f - c * c, b * c - a * e, a * d - b * b)
    determinant = a * adjugate[0] + b * adjugate[1] + c * adjugate[2]
    x, y, z = right
    solution[0] = (adjugate[0] * x + adjugate[1] * y + adjugate[2] * z) / determinant
    solution[1] = (adjugate[1] * x + adjugate[3] * y + adjugate[4] * z) / determinant
    solution[2] = (adjugate[2] * x + adjugate[4] * y + adjugate[5] * z) / determinant


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


@kernel
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
