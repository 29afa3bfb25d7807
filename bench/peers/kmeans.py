"""K-means clustering of the face centres: the simplest method that cuts a mesh into a given number of parts."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial.distance import cdist

from bench.peers import pieces
from bench.peers.method import Outcome, source_digest
from bench.princeton import surface

if TYPE_CHECKING:
    from segcore.arrays import FloatArray, LongArray
    from segcore.mesh import Mesh

_MOST_ROUNDS = 100  # a limit in case the clusters do not settle


@dataclass(frozen=True, slots=True)
class KMeans:
    """Lloyd's algorithm on the face centres, weighted by area; then every cluster is made connected.

    The seeds are chosen as for the k-means of the Princeton benchmark: repeatedly the face farthest from all seeds so
    far; the first one is the farthest from the centroid of the surface. Distances are Euclidean.

    References
    ----------
    Shlafman, Tal, Katz, Metamorphosis of polyhedral surfaces using decomposition, Eurographics 2002.
    """

    key = "kmeans"
    title = "k-means"

    @property
    def settings(self) -> str:
        return source_digest(__file__, pieces.__file__, surface.__file__)

    def prepare(self) -> None:
        """Do nothing."""

    def warm_up(self) -> None:
        """Do nothing."""

    def __call__(self, mesh: Mesh, segments: int) -> Outcome:
        start = time.process_time()
        whole = surface.Surface.from_mesh(mesh.vertices, mesh.faces)
        cluster = weighted_kmeans(mesh.corners.mean(axis=1), whole.face_area, segments)
        labels = pieces.keep_largest_pieces(mesh.vertices, whole, cluster)
        return Outcome(labels, time.process_time() - start)


def weighted_kmeans(points: FloatArray, weight: FloatArray, clusters: int) -> LongArray:
    """(N,) cluster 0, 1, ... of every point (N, 3), at a fixed point of Lloyd's algorithm or after 100 rounds.

    A cluster that loses all of its weight keeps its centre.
    """
    centres = _farthest_first(points, np.average(points, axis=0, weights=weight), clusters)
    cluster = _nearest(points, centres)
    for _ in range(_MOST_ROUNDS):
        mass = np.bincount(cluster, weight, minlength=clusters)
        held = mass > 0
        sums = [np.bincount(cluster, weight * points[:, axis], minlength=clusters) for axis in range(3)]
        centres[held] = np.stack(sums, axis=1)[held] / mass[held, None]
        before, cluster = cluster, _nearest(points, centres)
        if np.array_equal(before, cluster):
            break
    return cluster


def _farthest_first(points: FloatArray, origin: FloatArray, count: int) -> FloatArray:
    distance = np.linalg.norm(points - origin, axis=1)
    seeds = [int(np.argmax(distance))]
    distance = np.linalg.norm(points - points[seeds[0]], axis=1)
    while len(seeds) < count:
        seeds.append(int(np.argmax(distance)))
        distance = np.minimum(distance, np.linalg.norm(points - points[seeds[-1]], axis=1))
    return points[seeds]


def _nearest(points: FloatArray, centres: FloatArray) -> LongArray:
    nearest: LongArray = np.argmin(cdist(points, centres, "sqeuclidean"), axis=1)
    return nearest
