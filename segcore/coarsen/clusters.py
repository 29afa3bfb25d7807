"""The coarse graph that is cut in place of the mesh."""

from dataclasses import dataclass, replace

import numpy as np

from segcore.arrays import FloatArray, IntArray, group_sums
from segcore.coarsen.components import largest, nearest_hosts
from segcore.coarsen.matching import coarsen
from segcore.graphs.mesh_graph import MeshGraph
from segcore.graphs.surface_graph import SurfaceGraph, connected_components

MOST_COMPONENTS = 1024  # that have clusters of their own


@dataclass(frozen=True, slots=True, eq=False)
class Clusters:
    """Connected clusters of the nodes of a mesh graph as the nodes of a graph of their own."""

    graph: SurfaceGraph  # N clusters
    of_node: IntArray  # the cluster of every node of the mesh graph
    points: FloatArray  # (N, 3) their centres
    thickness: FloatArray | None  # (N,) their mean logarithm of the shape diameter over sqrt(total area)


def cluster_nodes(mesh_graph: MeshGraph, target: int, rng: np.random.Generator) -> Clusters:
    """Coarsen a mesh graph to about ``target`` clusters, or not at all where ``target`` is 0.

    A cluster lies in one component. Of more than 1024 components all but the largest join, as a whole, the cluster that
    is nearest to them.
    """
    graph, points = mesh_graph.graph, mesh_graph.points
    component = connected_components(graph.edges, graph.node_count)
    is_host = largest(component, graph.volume, MOST_COMPONENTS)
    if is_host.all():
        coarse, of_node = coarsen(graph, target or graph.node_count, rng)
    else:
        host_nodes = np.flatnonzero(is_host[component]).astype(np.int32)
        coarse, of_host = coarsen(graph.subgraph(host_nodes), target or graph.node_count, rng)
        of_node = _with_followers(of_host, host_nodes, component, nearest_hosts(component, is_host, points))
    volume = group_sums(of_node, graph.volume)
    centres = np.stack([group_sums(of_node, graph.volume * points[:, axis]) / volume for axis in range(3)], axis=1)
    thickness = mesh_graph.thickness
    mean = None if thickness is None else group_sums(of_node, graph.volume * thickness) / volume
    return Clusters(replace(coarse, volume=volume), of_node, centres, mean)


def _with_followers(of_host: IntArray, host_nodes: IntArray, component: IntArray, pairs: IntArray) -> IntArray:
    """(N,): the cluster of every node, that of the hosts and of the components that follow one of them."""
    of_node = np.empty(len(component), dtype=np.int32)
    of_node[host_nodes] = of_host
    of_component = np.full(int(component.max()) + 1, -1, dtype=np.int32)
    of_component[component[pairs[:, 0]]] = of_node[pairs[:, 1]]
    follows = of_component[component] >= 0
    of_node[follows] = of_component[component[follows]]
    return of_node
