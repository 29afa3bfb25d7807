"""Assemblies: components that touch are connected, so that a body of many pieces is cut like any other."""

from dataclasses import replace

import numpy as np

from segcore.arrays import IntArray, group_sums
from segcore.clean.edge_geometry import edge_lengths
from segcore.clean.surface import Surface
from segcore.coarsen.authored import apart, largest_of_each_part
from segcore.coarsen.clusters import Clusters
from segcore.coarsen.components import largest, nearest_hosts
from segcore.coarsen.contacts import POINTS, Links, find_contacts, spread_points
from segcore.graphs.mesh_graph import MeshGraph
from segcore.graphs.surface_graph import connected_components

# Affinity across a contact: less than that of any edge, which is at least 0.03. Its neighbours are compared in
# docs/algorithm.md, "Constants" of section 3.
CONTACT = 0.01
NEGLIGIBLE = 0.002  # share of the total area below which an assembly is attached to its neighbour, as cut/rules.py has
# Least length of a contact, in the extent: eigenvectors see no weights below 1e-16 of others. Set by hand.
_SHORTEST = 1e-9
_SMALLEST_SIZE = 1e-4  # least size of a surface, in extents of its bounding box, in the search for contacts


def assemble(surface: Surface, nodes: MeshGraph, clusters: Clusters, most: int) -> tuple[Clusters, Links]:
    """Clusters with edges between components that touch, and the faces that these edges link.

    Parameters
    ----------
    most : number of components of the new graph, at most, unless there are more authored parts.
    """
    if clusters.body.max() == 0:
        return clusters, Links.none()
    of_face = clusters.of_node[nodes.of_face]
    links = link_components(surface, clusters.body[of_face], most)
    border = _border_per_length(surface, nodes) * links.length
    return replace(clusters, graph=clusters.graph.with_edges(of_face[links.faces], CONTACT * border, border)), links


def _border_per_length(surface: Surface, nodes: MeshGraph) -> float:
    """The border, in the unit of a graph, of an edge of length 1: 1 on faces, the number of edges on vertices."""
    length = float(edge_lengths(surface).sum())
    return float(nodes.graph.length.sum()) / length if length > 0.0 else 1.0


def link_components(surface: Surface, component: IntArray, most: int) -> Links:
    """Connect the components of a surface to at most ``most`` assemblies that lie apart.

    Components that touch are linked along their contacts. An assembly with less than 0.2 % of the total area, and every
    one beyond the ``most`` largest, is attached to the nearest of the others. Components of different authored parts
    are not linked, and every part keeps an assembly.

    Parameters
    ----------
    component : (F,) the component 0..C - 1 of every face.
    """
    if component.max() == 0:
        return Links.none()
    points = spread_points(surface, component, POINTS)
    own = component[points.face]
    size = np.clip(np.sqrt(surface.areas.sum()), _SMALLEST_SIZE, 1.0)  # many components can have a large area
    contacts = _within_parts(find_contacts(points, own, float(size)), surface.authored)
    assembly = _assemblies(component, contacts)[own]
    authored = None if surface.authored is None else surface.authored[points.face]
    is_host = largest(assembly, points.area, most, NEGLIGIBLE)
    is_host |= largest_of_each_part(assembly, points.area, authored)
    attached = nearest_hosts(assembly, is_host, apart(points.position, authored))
    length = np.sqrt(group_sums(assembly, points.area)[assembly[attached[:, 0]]])
    return Links(
        np.concatenate([contacts.faces, points.face[attached]]),
        np.concatenate([contacts.length, np.maximum(length, _SHORTEST)]),
        np.concatenate([contacts.concavity, np.zeros(len(length))]),
    )


def _within_parts(links: Links, authored: IntArray | None) -> Links:
    """The links between faces of the same authored part."""
    if authored is None:
        return links
    inside = authored[links.faces[:, 0]] == authored[links.faces[:, 1]]
    return Links(links.faces[inside], links.length[inside], links.concavity[inside])


def _assemblies(component: IntArray, links: Links) -> IntArray:
    """(C,) the assembly of every component."""
    return connected_components(component[links.faces], int(component.max()) + 1)
