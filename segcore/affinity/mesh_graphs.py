"""The graphs of a surface: its faces or its vertices as nodes, weighted by an affinity."""

import numpy as np

from segcore.affinity.affinities import FACE_AFFINITIES, VERTEX_AFFINITIES
from segcore.affinity.flatness import cohesive_weights, smooth_edges
from segcore.array_kernels import face_centroids
from segcore.arrays import BoolArray, IntArray, at_least
from segcore.clean.edge_geometry import edge_lengths
from segcore.clean.surface import Surface
from segcore.clean.topology import mesh_edges
from segcore.coarsen.authored import part_of_component
from segcore.graphs.mesh_graph import MeshGraph
from segcore.graphs.surface_graph import SurfaceGraph, connected_components, weighted_degrees
from segcore.parameters import SegmentationParameters
from segcore.progress import OnPart, report_nothing
from segcore.threads import meanwhile

# Set by hand: a face of the least area has edges of about the least length. Without a least length a triangle whose
# corners nearly coincide is the cheapest cut of its segment (tests/segcore/test_laws.py).
_SMALLEST_FACE = 1e-4  # least volume of a face in mean areas
_SHORTEST_EDGE = 1e-2  # least length of an edge in mean lengths


def mesh_graph(
    surface: Surface,
    parameters: SegmentationParameters,
    is_piece: BoolArray | None = None,
    on_part: OnPart = report_nothing,
) -> MeshGraph:
    """The graph of a surface that the parameters select, weighted by the affinity that they select.

    Parameters
    ----------
    is_piece : (F,) True for faces that are pieces of a face that was divided; None if there are none.
    on_part : called with the fraction of the stage "affinity" that is done.
    """
    if parameters.graph == "vertices":
        return vertex_graph(surface, parameters)
    return face_dual_graph(surface, parameters, is_piece, on_part)


def face_dual_graph(
    surface: Surface,
    parameters: SegmentationParameters,
    is_piece: BoolArray | None = None,
    on_part: OnPart = report_nothing,
) -> MeshGraph:
    """The face dual graph: W = edge length times affinity, the volume of a node is the area of its face.

    Inside flat and smoothly bent faces the affinities "learned" and "concavity" are raised, see
    ``segcore.affinity.flatness``, and the walls of holes have no volume.

    Areas are at least 1e-4 of the mean area and lengths at least 1e-2 of the mean length, so that degenerate faces and
    edges have a positive weight and a face that is nearly a point is not the cheapest cut.
    """
    smooth = meanwhile(smooth_edges, surface, is_piece) if parameters.measures_shape else None
    affinity = FACE_AFFINITIES[parameters.affinity](surface, parameters, on_part)
    length = at_least(edge_lengths(surface), _SHORTEST_EDGE)
    weight = length * affinity.value
    volume = at_least(surface.areas, _SMALLEST_FACE)
    if smooth is not None:
        found = smooth()
        weight = cohesive_weights(found, weight, length)
        volume = np.where(found.wall, _SMALLEST_FACE * surface.areas.mean(), volume)
    graph = SurfaceGraph(surface.edge_faces, weight, volume, length)
    centroids = face_centroids(surface.vertices, surface.faces)
    return MeshGraph(
        graph,
        centroids,
        None,
        affinity.thickness,
        affinity.confidence,
        surface.authored,
        affinity.grain,
        affinity.opposites,
    )


def vertex_graph(surface: Surface, parameters: SegmentationParameters) -> MeshGraph:
    """The vertex graph of the paper: W = affinity, the volume of a node is its weighted degree.

    A vertex at which components touch is a node of each of them.
    """
    corners, vertex = _vertices_of_components(surface)
    edges = mesh_edges(corners)
    affinity = VERTEX_AFFINITIES[parameters.affinity](surface, vertex[edges], parameters)
    degrees = weighted_degrees(edges, affinity, len(vertex))
    graph = SurfaceGraph(edges, affinity, degrees, np.ones(len(edges)))
    authored = None if surface.authored is None else part_of_component(corners.ravel(), np.repeat(surface.authored, 3))
    return MeshGraph(graph, surface.vertices[vertex], corners, authored=authored)


def _vertices_of_components(surface: Surface) -> tuple[IntArray, IntArray]:
    """(F, 3) the nodes at the corners of every face, and (N,) the vertex of every node."""
    component = connected_components(surface.edge_faces, len(surface.faces)).astype(np.int64)
    keys = component[:, None] * len(surface.vertices) + surface.faces
    unique, corners = np.unique(keys, return_inverse=True)
    return corners.reshape(-1, 3).astype(np.int32), (unique % len(surface.vertices)).astype(np.int32)
