"""Closed meshes with bores and walls, and what is measured of solids, for the tests."""

import numpy as np
import trimesh
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from segcore.arrays import FloatArray, IntArray
from segcore.hierarchy import Hierarchy
from segcore.mesh import Mesh, face_normals_and_areas


def lathe(profile: list[tuple[float, float]], sections: int = 32, rounds: int = 2) -> Mesh:
    """The closed surface that a line of points (radius, height) sweeps around the z axis, its faces cut in four."""
    turned = trimesh.creation.revolve(np.array(profile), sections=sections)
    for _ in range(rounds):
        turned = turned.subdivide()
    if turned.volume < 0:
        turned.invert()
    return Mesh(turned.vertices, turned.faces)


def pipe(sections: int = 32) -> Mesh:
    """A thick pipe along z from -2 to 2, with the radii 0.8 and 1."""
    return lathe([(0.8, -2), (1, -2), (1, 0), (1, 2), (0.8, 2), (0.8, 0), (0.8, -2)], sections)


def cup(sections: int = 32) -> Mesh:
    """A cup of height 2 and radius 1, open at the top, with walls of 0.1."""
    return lathe([(0, 0), (1, 0), (1, 1), (1, 2), (0.9, 2), (0.9, 1), (0.9, 0.1), (0, 0.1)], sections)


def halves(mesh: Mesh, in_first: np.ndarray) -> Hierarchy:
    """A hierarchy with one cut, between the faces that are in the first half and the others."""
    area = face_normals_and_areas(mesh.corners)[1]
    leaf = np.where(in_first, 1, 2).astype(np.int32)
    return Hierarchy(
        split_node=np.array([0], dtype=np.int32),
        cut_value=np.array([1.0]),
        area=np.array([area.sum(), area[in_first].sum(), area[~in_first].sum()]),
        face_count=np.array([len(leaf), in_first.sum(), (~in_first).sum()], dtype=np.int32),
        face_leaf=leaf,
        automatic_segments=2,
    )


def volume(vertices: FloatArray, faces: IntArray) -> float:
    """The volume that closed faces enclose."""
    corners = vertices[faces] - vertices.mean(axis=0)
    return float(np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6)


def fans(faces: IntArray) -> int:
    """The number of sets of corners at one vertex that are connected by edges: that of vertices of a manifold."""
    corner = np.arange(faces.size).reshape(-1, 3)
    at_edge: dict[tuple[int, int], list[tuple[int, int]]] = {}
    for face, corners in zip(faces.tolist(), corner.tolist(), strict=True):
        for k in range(3):
            a, b = sorted([(face[k], corners[k]), (face[k - 1], corners[k - 1])])
            at_edge.setdefault((a[0], b[0]), []).append((a[1], b[1]))
    pairs = np.array([(a, b) for (one, other, *_) in at_edge.values() for a, b in zip(one, other, strict=True)])
    joined = coo_array((np.ones(len(pairs)), pairs.T), shape=(faces.size, faces.size))
    count: int = connected_components(joined, directed=False)[0]
    return count
