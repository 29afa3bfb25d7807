"""Meshes cut into patches that do not share vertices, as CAD tessellations and booleans leave them."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial import KDTree

from segcore import shapes
from segcore.arrays import BoolArray, IntArray
from segcore.mesh import Mesh
from segcore.shapes import subdivide


class Patched(NamedTuple):
    """A mesh of patches, and the face of the whole mesh that every face comes from."""

    mesh: Mesh
    source: IntArray  # (F,)


def patches_around(mesh: Mesh, count: int, rng: np.random.Generator) -> IntArray:
    """(F,) the nearest of some faces chosen at random."""
    centres = mesh.corners.mean(axis=1)
    seeds = centres[rng.choice(len(centres), count, replace=False)]
    return KDTree(seeds).query(centres)[1].astype(np.int32)


def flat_patches(mesh: Mesh) -> IntArray:
    """(F,) the plane of every face."""
    normal = np.cross(*np.diff(mesh.corners, axis=1).transpose(1, 0, 2))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    plane = np.concatenate([normal, (normal * mesh.corners[:, 0]).sum(axis=1, keepdims=True)], axis=1)
    return np.unique(np.round(plane, 6) + 0.0, axis=0, return_inverse=True)[1].ravel().astype(np.int32)


def patched(
    mesh: Mesh,
    patch: IntArray,
    gap: float,
    rng: np.random.Generator,
    levels: tuple[int, ...] = (0,),
    turn: bool = False,
) -> Patched:
    """Every patch with its own vertices.

    Parameters
    ----------
    gap : in extents; border vertices are moved by up to so much along each axis, at every patch in its own way.
    levels : every patch is subdivided in its plane so many times, chosen at random, which leaves T-junctions.
    turn : reverse the faces of every second patch, chosen at random.
    """
    extent = float(np.ptp(mesh.vertices, axis=0).max())
    pieces, sources = [], []
    for one in np.unique(patch):
        source = np.flatnonzero(patch == one)
        used, faces = np.unique(mesh.faces[source], return_inverse=True)
        vertices, faces = mesh.vertices[used], faces.reshape(-1, 3).astype(np.int32)
        for _ in range(rng.choice(levels)):
            vertices, faces = subdivide(vertices, faces)
            source = np.repeat(source, 4)
        noise = gap * extent * rng.uniform(-1, 1, vertices.shape)
        vertices = vertices + noise * on_border(faces, len(vertices))[:, None]
        pieces.append(Mesh(vertices, faces[:, ::-1] if turn and rng.random() < 0.5 else faces))
        sources.append(source)
    return Patched(shapes.joined(*pieces).mesh, np.concatenate(sources).astype(np.int32))


def on_border(faces: IntArray, count: int) -> BoolArray:
    """(V,) True for the ends of edges of one face."""
    edges = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    unique, uses = np.unique(edges, axis=0, return_counts=True)
    border = np.zeros(count, dtype=bool)
    border[unique[uses == 1]] = True
    return border


def sheet(corner: ArrayLike, along: ArrayLike, across: ArrayLike, pieces: tuple[int, int]) -> Mesh:
    """A parallelogram of quads, each of two faces.

    Parameters
    ----------
    corner, along, across : (3,) a corner and the two sides.
    pieces : number of quads along both sides.
    """
    s, t = np.meshgrid(np.linspace(0, 1, pieces[0] + 1), np.linspace(0, 1, pieces[1] + 1), indexing="ij")
    vertices = np.array(corner) + s.reshape(-1, 1) * np.array(along) + t.reshape(-1, 1) * np.array(across)
    index = np.arange(len(vertices)).reshape(s.shape)
    a, b, c, d = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
    faces = np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)
    return Mesh(vertices, faces.astype(np.int32))


def tube(radius: float, low: float, high: float, around: int, turn: float = 0.0) -> Mesh:
    """An open cylinder around the z axis, its faces looking outward."""
    flat = sheet([0, 0, 0], [1, 0, 0], [0, 1, 0], (around, 4))
    angle = 2 * np.pi * flat.vertices[:, 0] + turn
    height = low + (high - low) * flat.vertices[:, 1]
    return Mesh(np.stack([radius * np.cos(angle), radius * np.sin(angle), height], axis=1), flat.faces)
