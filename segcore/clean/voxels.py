"""Voxel models: surfaces of equal cubes, whose steps are no creases."""

from dataclasses import replace

import numpy as np
from scipy.sparse import coo_matrix

from segcore.arrays import FloatArray, IntArray
from segcore.clean.orientation import reliable_normals
from segcore.clean.solids import are_of_cubes
from segcore.clean.surface import Surface

# Set by hand: a block of 4 cubes in each direction has 192 faces, and 1/8 of its edges between faces are bent. A smooth
# shape of voxels has a third of bent edges or more.
_LEAST_FACES = 192
_LEAST_BENT = 0.15
# Steps of Taubin smoothing, one that shrinks and one that grows the shape, and how often they are made. A step of one
# cube disappears; what is larger than three or four stays. Set by hand.
_SHRINK, _GROW, _TIMES = 0.5, -0.53, 20


def without_voxel_steps(surface: Surface) -> Surface:
    """Return the surface of a voxel model with its steps smoothed, any other surface as it is.

    A voxel model has squares of one size along the axes, divided into triangles, and many of its edges are steps.

    References
    ----------
    Taubin, A signal processing approach to fair surface design, SIGGRAPH 1995.
    """
    if not _is_voxel_model(surface):
        return surface
    vertices = _smoothed(surface.vertices, surface.faces)
    normals, areas = reliable_normals(vertices, surface.faces)
    return replace(surface, vertices=vertices, normals=normals, areas=areas)


def _is_voxel_model(surface: Surface) -> bool:
    areas, normals = surface.areas, surface.normals
    if len(areas) < _LEAST_FACES or not are_of_cubes(areas, normals):
        return False
    one, other = normals[surface.edge_faces].transpose(1, 0, 2)
    bent = np.einsum("ij,ij->i", one, other) < 0.5
    return len(bent) > 0 and float(bent.mean()) >= _LEAST_BENT


def _smoothed(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """The vertices after Taubin smoothing along the edges of the faces."""
    start, end = faces[:, [0, 1, 2, 1, 2, 0]].ravel(), faces[:, [1, 2, 0, 0, 1, 2]].ravel()
    count = len(vertices)
    edges = coo_matrix((np.ones(len(start)), (start, end)), shape=(count, count)).tocsr()
    edges.data[:] = 1.0
    degree = np.maximum(np.asarray(edges.sum(axis=1)), 1.0)
    for _ in range(_TIMES):
        for factor in (_SHRINK, _GROW):
            vertices = vertices + factor * (edges @ vertices / degree - vertices)
    return vertices
