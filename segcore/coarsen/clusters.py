"""The coarse graph that is cut in place of the mesh."""

from dataclasses import dataclass

import numpy as np

from segcore.arrays import FloatArray, IntArray, group_sums
from segcore.coarsen.authored import apart, largest_of_each_part, part_of_component
from segcore.coarsen.components import largest, nearest_hosts
from segcore.coarsen.matching import coarsen
from segcore.graphs.mesh_graph import MeshGraph
from segcore.graphs.surface_graph import SurfaceGraph, connected_components

MOST_COMPONENTS = 1024  # with clusters of their own; a limit on the size of the coarse graph, set by hand


@dataclass(frozen=True, slots=True, eq=False)
class Clusters:
    """Connected clusters of the nodes of a mesh graph, as the nodes of a graph."""

    graph: SurfaceGraph  # of N clusters
    of_node: IntArray  # the cluster of every node of the mesh graph
    points: FloatArray  # (N, 3) their centres
    thickness: FloatArray | None  # (N,) their mean logarithm of the shape diameter over sqrt(total area), if measured
    confidence: FloatArray | None  # (N,) share of the rays of the thickness that met the other side from inside
    body: IntArray  # (N,) the connected component of every cluster
    authored: IntArray | None = None  # (N,) the part of the structure of the file, if the cuts follow it
    image: IntArray | None = None  # (N,) the mirror image of every cluster, if the surface is symmetric


def cluster_nodes(mesh_graph: MeshGraph, target: int, rng: np.random.Generator) -> Clusters:
    """Coarsen a mesh graph to about ``target`` clusters, or not at all if ``target`` is 0.

    A cluster lies in one component and in one authored part. Of more than 1,024 components all but the largest, and the
    largest of each authored part, are merged, as a whole, with the cluster that is nearest to them.
    """
    graph, points = mesh_graph.graph, mesh_graph.points
    component = connected_components(graph.edges, graph.node_count)
    authored, grain = mesh_graph.authored, mesh_graph.grain
    is_host = largest(component, graph.volume, MOST_COMPONENTS)
    is_host |= largest_of_each_part(component, graph.volume, authored)
    if is_host.all():
        coarse, of_node = coarsen(graph, target or graph.node_count, rng, grain=grain)
    else:
        host_nodes = np.flatnonzero(is_host[component]).astype(np.int32)
        of_host_nodes = None if grain is None else grain[host_nodes]
        coarse, of_host = coarsen(graph.subgraph(host_nodes), target or graph.node_count, rng, grain=of_host_nodes)
        pairs = nearest_hosts(component, is_host, apart(points, authored))
        of_node = _with_small_components(of_host, host_nodes, component, pairs)
    return _with_means(coarse, of_node, mesh_graph)


def clusters_of(mesh_graph: MeshGraph, of_node: IntArray) -> Clusters:
    """The clusters that are given by (N,) the cluster 0, 1, ... of every node of a mesh graph."""
    graph = mesh_graph.graph
    ends = of_node[graph.edges]
    across = ends[:, 0] != ends[:, 1]
    coarse = SurfaceGraph.with_sums(ends[across], graph.weight[across], graph.volume, graph.length[across])
    return _with_means(coarse, of_node, mesh_graph)


def _with_means(coarse: SurfaceGraph, of_node: IntArray, mesh_graph: MeshGraph) -> Clusters:
    """Clusters with their volumes, and with the means of places and thickness over their nodes."""
    volume = mesh_graph.graph.volume
    points = mesh_graph.points
    total = group_sums(of_node, volume)
    centres = np.stack([group_sums(of_node, volume * points[:, axis]) / total for axis in range(3)], axis=1)
    thickness, confidence = (
        None if values is None else group_sums(of_node, volume * values) / total
        for values in (mesh_graph.thickness, mesh_graph.confidence)
    )
    authored = None if mesh_graph.authored is None else part_of_component(of_node, mesh_graph.authored)
    body = connected_components(coarse.edges, len(total))
    return Clusters(coarse._replace(volume=total), of_node, centres, thickness, confidence, body, authored)


def _with_small_components(of_host: IntArray, host_nodes: IntArray, component: IntArray, pairs: IntArray) -> IntArray:
    """(N,) the cluster of every node.

    Parameters
    ----------
    of_host : (H,) the clusters of the nodes of the host components.
    host_nodes : (H,) these nodes.
    component : (N,) the component of every node.
    pairs : (C, 2) a node of every other component and the node of a host whose cluster it joins.
    """
    of_node = np.empty(len(component), dtype=np.int32)
    of_node[host_nodes] = of_host
    of_component = np.full(int(component.max()) + 1, -1, dtype=np.int32)
    of_component[component[pairs[:, 0]]] = of_node[pairs[:, 1]]
    joins = of_component[component] >= 0
    of_node[joins] = of_component[component[joins]]
    return of_node
