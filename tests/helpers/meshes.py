"""Variants of meshes, and measures of labelings, for the tests."""

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from segcore.arrays import FloatArray, IntArray
from segcore.mesh import Mesh
from segcore.shapes import subdivide


def pieces_of_labels(mesh: Mesh, labels: IntArray) -> int:
    """The number of connected sets of faces with equal labels (across shared edges), counted without segcore."""
    edges = np.sort(mesh.faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    owner = np.repeat(np.arange(len(mesh.faces)), 3)
    edges, owner = np.concatenate([edges, labels[owner, None]], axis=1), owner
    _, which = np.unique(edges, axis=0, return_inverse=True)
    joined = coo_array((np.ones(len(owner)), (owner, which)), shape=(len(mesh.faces), which.max() + 1)).tocsr()
    count: int = connected_components(joined @ joined.T, directed=False)[0]
    return count


def agreement(labels: IntArray, others: IntArray, weights: FloatArray) -> float:
    """The share of the weight for which two labelings agree after the best matching of their labels."""
    from scipy.optimize import linear_sum_assignment

    table = np.zeros((labels.max() + 1, others.max() + 1))
    np.add.at(table, (labels, others), weights)
    rows, columns = linear_sum_assignment(-table)
    return float(table[rows, columns].sum() / weights.sum())


def areas(mesh: Mesh) -> FloatArray:
    """(F,) areas of the faces."""
    corners = mesh.corners
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area: FloatArray = 0.5 * np.linalg.norm(cross, axis=1)
    return area


def rotation(rng: np.random.Generator) -> FloatArray:
    """A random rotation matrix (3, 3)."""
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    q[:, 0] *= np.sign(np.linalg.det(q))
    return q


def exploded(mesh: Mesh) -> Mesh:
    """The same faces, each with its own three vertices, as in an STL file."""
    return Mesh(mesh.corners.reshape(-1, 3), np.arange(3 * len(mesh.faces)).reshape(-1, 3))


def moved(mesh: Mesh, by: tuple[float, float, float]) -> Mesh:
    """The mesh translated by a vector."""
    return Mesh(mesh.vertices + np.array(by), mesh.faces)


def refined(mesh: Mesh, times: int) -> Mesh:
    """Every face cut in four in its plane, several times."""
    vertices, faces = mesh.vertices, mesh.faces
    for _ in range(times):
        vertices, faces = subdivide(vertices, faces)
    return Mesh(vertices, faces)
