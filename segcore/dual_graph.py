"""The graph of the faces of a surface, and the coarse graph of clusters of faces that is cut in its place."""

from dataclasses import dataclass

import numpy as np

from segcore.affinity import edge_lengths
from segcore.arrays import FloatArray, IntArray, group_sums
from segcore.coarsen import coarsen
from segcore.components import follow_hosts
from segcore.graph import SurfaceGraph, connected_components
from segcore.surface import Surface

_SMALLEST_FACE = 1e-4  # least volume of a face, in mean areas


@dataclass(frozen=True, slots=True, eq=False)
class FaceClusters:
    """Connected clusters of faces as the nodes of a graph."""

    graph: SurfaceGraph  # N clusters
    of_face: IntArray  # (F,) the cluster of every face
    centroids: FloatArray  # (N, 3)


def face_dual_graph(surface: Surface, affinity: FloatArray) -> SurfaceGraph:
    """The face dual graph: W = edge length times affinity, the volume of a node is the area of its face.

    A face counts for at least 1e-4 of the mean area, so that degenerate ones do not vanish from the sums.

    Parameters
    ----------
    affinity : (E,) in (0, 1], one number for every dual edge of the surface.
    """
    tiny = float(np.finfo(float).tiny)
    volume = np.maximum(surface.areas, max(_SMALLEST_FACE * float(surface.areas.mean()), tiny))
    return SurfaceGraph(surface.edge_faces, np.maximum(edge_lengths(surface) * affinity, tiny), volume)


def cluster_faces(
    surface: Surface,
    graph: SurfaceGraph,
    affinity: FloatArray,
    target: int,
    most_components: int,
    rng: np.random.Generator,
) -> FaceClusters:
    """Coarsen the face dual graph to about ``target`` clusters.

    Of more than ``most_components`` components the negligible ones join the clusters nearest to them.

    Parameters
    ----------
    affinity : (E,) as in :func:`face_dual_graph`.
    """
    faces_at = surface.vertices[surface.faces].mean(axis=1)
    hosts, followed = follow_hosts(connected_components(graph), graph.volume, faces_at, most_components)
    is_host = np.zeros(graph.node_count, dtype=bool)
    is_host[hosts] = True
    kept = is_host[graph.edges[:, 0]]  # an edge has both ends in one component
    host_graph = SurfaceGraph(followed[graph.edges[kept]], graph.weight[kept], graph.volume[hosts])
    coarse, of_host = coarsen(host_graph, affinity[kept], target, rng)
    of_face = of_host[followed]
    volume = group_sums(of_face, graph.volume)
    centroids = np.stack([group_sums(of_face, graph.volume * faces_at[:, axis]) / volume for axis in range(3)], axis=1)
    return FaceClusters(SurfaceGraph(coarse.edges, coarse.weight, volume), of_face, centroids)
