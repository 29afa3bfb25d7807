"""The affinity of Chahhou et al. 2014, section 4.2: 1, and less on edges that touch a concave region."""

import numpy as np

from segcore.affinity.concave_regions import DEEP, concave_vertices, z_scores
from segcore.affinity.curvature import principal_curvatures
from segcore.arrays import BoolArray, FloatArray, IntArray
from segcore.clean.surface import Surface
from segcore.clean.topology import mesh_edges
from segcore.graphs.surface_graph import rows_of
from segcore.parameters import SegmentationParameters

# The numbers of the paper.
_STEEP = 2.0  # difference of the z-scores at the ends of an edge from which it is steep
_ACROSS_STEEP = 0.1  # affinity of steep edges that touch a concave region
_ACROSS = 0.2  # affinity of other edges that touch one


def minima_rule_of_vertices(surface: Surface, ends: IntArray, parameters: SegmentationParameters) -> FloatArray:
    """(E,) the weights of the paper on the vertex graph.

    An edge that touches a vertex of a concave region has g = 0.1 if the z-scores of the minimum curvature at its ends
    differ by 2 or more, else 0.2.

    Parameters
    ----------
    ends : (E, 2) vertices.
    """
    z, concave = _concave_regions(surface, parameters)
    return _weights(concave[ends[:, 0]] | concave[ends[:, 1]], z[ends])


def minima_rule_of_faces(surface: Surface, parameters: SegmentationParameters) -> FloatArray:
    """(E,) the same rule on the face dual graph.

    An edge of the mesh lies in a concave region if both of its ends do, or, without thinning, if their mean z-score is
    below -0.8. The z-score of a face is the mean over its corners.
    """
    z, concave = _concave_regions(surface, parameters)
    along = surface.edge_vertices
    if parameters.thinning == "none":
        inside = z[along].mean(axis=1) < DEEP
    else:
        inside = concave[along[:, 0]] & concave[along[:, 1]]
    return _weights(inside, z[surface.faces].mean(axis=1)[surface.edge_faces])


def _concave_regions(surface: Surface, parameters: SegmentationParameters) -> tuple[FloatArray, BoolArray]:
    """(V,) z-scores of the minimum curvature, and (V,) True for vertices of concave regions."""
    curvatures = principal_curvatures(surface.vertices, surface.faces)
    edges = mesh_edges(surface.faces)
    rows = rows_of(edges, len(surface.vertices))
    return z_scores(curvatures.k2), concave_vertices(curvatures, rows, parameters.thinning)


def _weights(inside: BoolArray, z: FloatArray) -> FloatArray:
    """(E,) affinities, from whether an edge lies in a concave region and the z-scores (E, 2) at its two ends."""
    steep = np.abs(z[:, 0] - z[:, 1]) >= _STEEP
    return np.where(inside, np.where(steep, _ACROSS_STEEP, _ACROSS), 1.0)
