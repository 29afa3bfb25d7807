"""How strongly two neighbouring faces belong together: the edge weights of the face dual graph.

An affinity turns a surface into g, one number in (0, 1] for every dual edge; the weight of the edge is its length
times g and the volume of a node is the area of its face, so that cuts and volumes do not depend on how finely the
shape is meshed.
"""

import numpy as np
from numba import njit

from segcore.arrays import BoolArray, FloatArray, IntArray
from segcore.concavity import DEEP, concave_vertices, z_scores
from segcore.curvature import principal_curvatures
from segcore.graph import rows_of
from segcore.parameters import SegmentationParameters
from segcore.surface import Surface
from segcore.topology import mesh_edges

_FLOOR = 0.03  # g of the deepest concavity: lower lets noise be cut out, higher lets concavities be ignored
_ANGLE_SCALE = 1.0  # concave dihedral angles are measured in mean absolute dihedral angles of the mesh
_CURVATURE_SCALE = 8.0  # concave minimum curvatures are measured in 1 / sqrt(total area)

# The minima rule of the paper.
_STEEP = 2.0  # difference of z-scores
_ACROSS_STEEP = 0.1
_ACROSS = 0.2


def concavity(surface: Surface, _: SegmentationParameters) -> FloatArray:
    """g = 0.03 + 0.97 exp(-(x1 + x2 / 8)) on every dual edge.

    x1 = max(0, -theta) / mean |theta|, theta the dihedral angle (0 where flat, negative where concave), the mean
    weighted by edge length; x2 = sqrt(A) max(0, -k2), k2 the minimum curvature averaged over the ends of the edge, A
    the total area.

    Returns
    -------
    (E,) in (0.03, 1].
    """
    theta = dihedral_angles(surface)
    length = edge_lengths(surface)
    typical = float(np.dot(length, np.abs(theta)) / max(length.sum(), np.finfo(float).tiny))
    k2 = principal_curvatures(surface.vertices, surface.faces).k2
    along_edge = 0.5 * (k2[surface.edge_vertices[:, 0]] + k2[surface.edge_vertices[:, 1]])
    x1 = np.maximum(0.0, -theta) / max(typical, np.finfo(float).tiny)
    x2 = np.sqrt(surface.areas.sum()) * np.maximum(0.0, -along_edge)
    affinity: FloatArray = _FLOOR + (1.0 - _FLOOR) * np.exp(-(x1 / _ANGLE_SCALE + x2 / _CURVATURE_SCALE))
    return affinity


def adjacency_of_faces(surface: Surface, _: SegmentationParameters) -> FloatArray:
    """g = 1: the standard adjacency matrix."""
    return np.ones(len(surface.edge_faces))


def adjacency_of_vertices(_surface: Surface, ends: IntArray, _: SegmentationParameters) -> FloatArray:
    """g = 1: the standard adjacency matrix."""
    return np.ones(len(ends))


def minima_rule_of_vertices(surface: Surface, ends: IntArray, parameters: SegmentationParameters) -> FloatArray:
    """The matrix of Chahhou et al. 2014, section 4.2: 1, and less on edges that touch a vertex of a concave region.

    There g = 0.1 where the z-scores of the minimum curvature differ by 2 or more along the edge, else 0.2.

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


FACE_AFFINITIES = {"concavity": concavity, "minima_rule": minima_rule_of_faces, "adjacency": adjacency_of_faces}
VERTEX_AFFINITIES = {"minima_rule": minima_rule_of_vertices, "adjacency": adjacency_of_vertices}


def _concave_regions(surface: Surface, parameters: SegmentationParameters) -> tuple[FloatArray, BoolArray]:
    """z-score of the minimum curvature of every vertex, and which vertices lie in a concave region."""
    curvatures = principal_curvatures(surface.vertices, surface.faces)
    edges = mesh_edges(surface.faces)
    rows = rows_of(edges, len(surface.vertices))
    return z_scores(curvatures.k2), concave_vertices(curvatures, rows, parameters.thinning)


def _weights(inside: BoolArray, z: FloatArray) -> FloatArray:
    steep = np.abs(z[:, 0] - z[:, 1]) >= _STEEP
    return np.where(inside, np.where(steep, _ACROSS_STEEP, _ACROSS), 1.0)


def dihedral_angles(surface: Surface) -> FloatArray:
    """(E,) angle between the normals of the two faces in radians, 0 where flat, negative where concave.

    Zero where one of the faces is a sliver without a reliable normal.
    """
    return _dihedral_angles(surface.vertices, surface.faces, surface.normals, surface.edge_faces)


def edge_lengths(surface: Surface) -> FloatArray:
    """(E,) length of the mesh edge that a dual edge crosses."""
    ends = surface.vertices[surface.edge_vertices]
    length: FloatArray = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    return length


@njit(cache=True)
def _dihedral_angles(vertices: FloatArray, faces: FloatArray, normals: FloatArray, pairs: FloatArray) -> FloatArray:
    theta = np.zeros(len(pairs))
    for e in range(len(pairs)):
        f, g = pairs[e, 0], pairs[e, 1]
        n, m = normals[f], normals[g]
        x, y, z = n[1] * m[2] - n[2] * m[1], n[2] * m[0] - n[0] * m[2], n[0] * m[1] - n[1] * m[0]
        cosine = n[0] * m[0] + n[1] * m[1] + n[2] * m[2]
        if cosine == 0.0 and x == 0.0 and y == 0.0 and z == 0.0:
            continue
        angle = np.arctan2(np.sqrt(x * x + y * y + z * z), cosine)
        side = 0.0
        for k in range(3):
            for axis in range(3):
                side += n[axis] * (vertices[faces[g, k], axis] - vertices[faces[f, k], axis])
        theta[e] = -angle if side > 0.0 else angle
    return theta
