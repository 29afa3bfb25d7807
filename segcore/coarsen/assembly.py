"""Assemblies: components that touch are joined, so that a body in many pieces is cut like any other."""

from dataclasses import replace

import numpy as np

from segcore.arrays import IntArray, group_sums
from segcore.clean.edge_geometry import edge_lengths
from segcore.clean.surface import Surface
from segcore.coarsen.clusters import Clusters
from segcore.coarsen.components import largest, nearest_hosts
from segcore.coarsen.contacts import POINTS, Links, find_contacts, spread_points
from segcore.graphs.mesh_graph import MeshGraph
from segcore.graphs.surface_graph import connected_components

CONTACT = 0.1  # affinity across a contact: that of a deep concave edge
NEGLIGIBLE = 0.002  # share of the total area below which an assembly follows its neighbour
_SMALLEST_SIZE = 1e-4  # of a surface, in extents of its bounding box, whose contacts are still searched for


def assemble(surface: Surface, nodes: MeshGraph, clusters: Clusters, most: int) -> tuple[Clusters, Links]:
    """Clusters with edges between those of components that touch, and the faces that these edges link.

    Parameters
    ----------
    most : the components of the new graph are at most as many.
    """
    component = connected_components(clusters.graph.edges, clusters.graph.node_count)
    if component.max() == 0:
        return clusters, Links.none()
    of_face = clusters.of_node[nodes.of_face]
    links = link_components(surface, component[of_face], most)
    border = _border_per_length(surface, nodes) * links.length
    return replace(clusters, graph=clusters.graph.with_edges(of_face[links.faces], CONTACT * border, border)), links


def _border_per_length(surface: Surface, nodes: MeshGraph) -> float:
    """How much border, in the unit of a graph, an edge of length 1 is: 1 on faces, the number of edges on vertices."""
    length = float(edge_lengths(surface).sum())
    return float(nodes.graph.length.sum()) / length if length > 0.0 else 1.0


def link_components(surface: Surface, component: IntArray, most: int) -> Links:
    """Join the components of a surface to at most ``most`` assemblies that lie apart.

    Components that touch are joined along their contacts. An assembly with less than 0.2 % of the total area, and every
    one beyond the ``most`` largest, hangs on the nearest of the others.

    Parameters
    ----------
    component : (F,) the component 0..C - 1 of every face.
    """
    if component.max() == 0:
        return Links.none()
    points = spread_points(surface, component, POINTS)
    own = component[points.face]
    size = np.clip(np.sqrt(surface.areas.sum()), _SMALLEST_SIZE, 1.0)  # a crowd can have more area than room
    contacts = find_contacts(points, own, float(size))
    assembly = _joined(component, contacts)[own]
    is_host = largest(assembly, points.area, most, NEGLIGIBLE)
    hanging = nearest_hosts(assembly, is_host, points.position)
    thread = np.sqrt(group_sums(assembly, points.area)[assembly[hanging[:, 0]]])
    return Links(
        np.concatenate([contacts.faces, points.face[hanging]]),
        np.concatenate([contacts.length, np.maximum(thread, np.finfo(float).tiny)]),
    )


def _joined(component: IntArray, links: Links) -> IntArray:
    """(C,) the assembly of every component."""
    ends = component[links.faces]
    return connected_components(ends, int(component.max()) + 1)
