"""The coarse graph that is cut in place of the mesh."""

from dataclasses import dataclass

import numpy as np

from segcore.arrays import FloatArray, IntArray, group_sums
from segcore.coarsen import coarsen
from segcore.components import follow_hosts
from segcore.graph import SurfaceGraph, connected_components
from segcore.mesh_graph import MeshGraph


@dataclass(frozen=True, slots=True, eq=False)
class Clusters:
    """Connected clusters of the nodes of a mesh graph as the nodes of a graph of their own."""

    graph: SurfaceGraph  # N clusters
    of_node: IntArray  # the cluster of every node of the mesh graph
    points: FloatArray  # (N, 3) their centres


def cluster_nodes(mesh_graph: MeshGraph, target: int, most_components: int, rng: np.random.Generator) -> Clusters:
    """Coarsen a mesh graph to about ``target`` clusters, or not at all where ``target`` is 0.

    Of more than ``most_components`` components the negligible ones join the clusters nearest to them.
    """
    graph, points = mesh_graph.graph, mesh_graph.points
    hosts, followed = follow_hosts(connected_components(graph), graph.volume, points, most_components)
    is_host = np.zeros(graph.node_count, dtype=bool)
    is_host[hosts] = True
    kept = is_host[graph.edges[:, 0]]  # an edge has both ends in one component
    host_graph = SurfaceGraph(followed[graph.edges[kept]], graph.weight[kept], graph.volume[hosts])
    coarse, of_host = coarsen(host_graph, mesh_graph.affinity[kept], target or graph.node_count, rng)
    of_node = of_host[followed]
    volume = group_sums(of_node, graph.volume)
    centres = np.stack([group_sums(of_node, graph.volume * points[:, axis]) / volume for axis in range(3)], axis=1)
    return Clusters(SurfaceGraph(coarse.edges, coarse.weight, volume), of_node, centres)
