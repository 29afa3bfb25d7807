"""The agreement of segmentations of one shape in two meshes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import linear_sum_assignment
from scipy.spatial import KDTree

from bench.irregular.versions import Remeshed

if TYPE_CHECKING:
    from segcore.arrays import FloatArray, IntArray
    from segcore.mesh import Mesh

# Samples on a mesh that shares no faces with the original; set by hand: several for each face of a benchmark model.
_POINTS = 200_000


def agreement(mesh: Mesh, labels: IntArray, other: Remeshed, other_labels: IntArray) -> float:
    """Return the share of the area on which two segmentations of a shape agree, after the best matching of segments.

    Parameters
    ----------
    labels, other_labels : (F,) of the faces of the original mesh and of the other one. If the meshes share no faces, a
        face of the original is compared with the face of the other one that is nearest to its centre.
    """
    if other.origin is None:
        one, two, area = labels, other_labels[_nearest_faces(mesh, other)], areas(mesh.vertices, mesh.faces)
    else:
        one, two, area = labels[other.origin], other_labels, areas(other.vertices, other.faces)
    shared = np.zeros((int(one.max()) + 1, int(two.max()) + 1))
    np.add.at(shared, (one, two), area)
    rows, columns = linear_sum_assignment(-shared)
    return float(shared[rows, columns].sum() / area.sum())


def areas(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """(F,) areas of faces."""
    a, b, c = vertices[faces].transpose(1, 0, 2)
    area: FloatArray = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    return area


def _nearest_faces(mesh: Mesh, other: Remeshed) -> IntArray:
    """(F,) for every face of a mesh, the face of the other one that has the sample nearest to its centre."""
    rng = np.random.default_rng(0)
    share = np.cumsum(areas(other.vertices, other.faces))
    face = np.searchsorted(share, share[-1] * (np.arange(_POINTS) + 0.5) / _POINTS)
    weights = rng.dirichlet(np.ones(3), _POINTS)
    points = np.einsum("pk,pkx->px", weights, other.vertices[other.faces[face]])
    nearest = np.asarray(KDTree(points).query(mesh.corners.mean(axis=1))[1])
    found: IntArray = face[nearest].astype(np.int32)
    return found
