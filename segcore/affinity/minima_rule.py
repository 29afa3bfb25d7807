"""The affinity of Chahhou et al. 2014, section 4.2: 1, and less on edges that touch a concave region."""

import numpy as np

from segcore.affinity.concave_regions import DEEP, concave_vertices, z_scores
from segcore.affinity.curvature import principal_curvatures
from segcore.arrays import BoolArray, FloatArray, IntArray
from segcore.clean.surface import Surface
from segcore.clean.topology import mesh_edges
from segcore.graphs.surface_graph import rows_of
from segcore.parameters import SegmentationParameters

_STEEP = 2.0  # difference of z-scores
_ACROSS_STEEP = 0.1
_ACROSS = 0.2


def minima_rule_of_vertices(surface: Surface, ends: IntArray, parameters: SegmentationParameters) -> FloatArray:
    """The matrix of the paper on the vertex graph.

    On edges that touch a vertex of a concave region g = 0.1 where the z-scores of the minimum curvature differ by 2 or
    more along the edge, else 0.2.

    Parameters
    ----------
    ends : (E, 2) vertices.
    """
    z, concave = _concave_regions(surface, parameters)
    return _weights(concave[ends[:, 0]] | concave[ends[:, 1]], z[ends])


def minima_rule_of_faces(surface: Surface, parameters: SegmentationParameters) -> FloatArray:
    """The same rule on the face dual graph.

    An edge of the mesh lies in a concave region where both of its ends do, or, without thinning, where their mean
    z-score is below -0.8. The z-score of a face is the mean of its corners.
    """
    z, concave = _concave_regions(surface, parameters)
    along = surface.edge_vertices
    if parameters.thinning == "none":
        inside = z[along].mean(axis=1) < DEEP
    else:
        inside = concave[along[:, 0]] & concave[along[:, 1]]
    return _weights(inside, z[surface.faces].mean(axis=1)[surface.edge_faces])


def _concave_regions(surface: Surface, parameters: SegmentationParameters) -> tuple[FloatArray, BoolArray]:
    """z-score of the minimum curvature of every vertex, and which vertices lie in a concave region."""
    curvatures = principal_curvatures(surface.vertices, surface.faces)
    edges = mesh_edges(surface.faces)
    rows = rows_of(edges, len(surface.vertices))
    return z_scores(curvatures.k2), concave_vertices(curvatures, rows, parameters.thinning)


def _weights(inside: BoolArray, z: FloatArray) -> FloatArray:
    steep = np.abs(z[:, 0] - z[:, 1]) >= _STEEP
    return np.where(inside, np.where(steep, _ACROSS_STEEP, _ACROSS), 1.0)
