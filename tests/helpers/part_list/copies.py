"""Copies of bodies as parts of one mesh: moved, mirrored and meshed differently."""

import numpy as np

from helpers.meshes import refined, rotation
from segcore import shapes
from segcore.arrays import FloatArray
from segcore.mesh import Mesh


def placed(mesh: Mesh, matrix: FloatArray, shift: FloatArray) -> Mesh:
    """The mesh under x -> matrix x + shift."""
    return Mesh(mesh.vertices @ matrix.T + shift, mesh.faces)


def copy_of(mesh: Mesh, rng: np.random.Generator, *, mirrored: bool = False, times: int = 0) -> Mesh:
    """A copy somewhere else, in another direction, its faces cut in four some times, in another order."""
    finer = refined(mesh, times)
    order = rng.permutation(len(finer.vertices))
    faces = np.argsort(order)[finer.faces[rng.permutation(len(finer.faces))]]
    matrix = rotation(rng) @ np.diag([-1.0 if mirrored else 1.0, 1.0, 1.0])
    return placed(Mesh(finer.vertices[order], faces[:, ::-1] if mirrored else faces), matrix, 10.0 * rng.normal(size=3))


def hand() -> Mesh:
    """Three boxes in a way that no rotation maps to its mirror image."""
    palm, finger = shapes.box((3.0, 1.0, 1.0)), shapes.box((1.0, 2.0, 1.0), (1.0, 1.5, 0.0))
    return shapes.joined(palm, finger, shapes.box((1.0, 1.0, 2.0), (-1.0, 0.0, 1.5))).mesh


def gear(teeth: int) -> Mesh:
    """A flat wheel with rectangular teeth around the axis z."""
    count = 4 * teeth
    angle = 2.0 * np.pi * np.arange(count) / count
    radius = np.where(np.arange(count) // 2 % 2 == 0, 0.9, 1.0)
    ring = np.stack([radius * np.cos(angle), radius * np.sin(angle), np.zeros(count)], axis=1)
    vertices = np.concatenate([ring, ring + np.array([0.0, 0.0, 0.3]), [[0.0, 0.0, 0.0], [0.0, 0.0, 0.3]]])
    i, j = np.arange(count), (np.arange(count) + 1) % count
    low, high = np.full(count, 2 * count), np.full(count, 2 * count + 1)
    rows = [(i, j, j + count), (i, j + count, i + count), (j, i, low), (i + count, j + count, high)]
    return Mesh(vertices, np.concatenate([np.stack(row, axis=1) for row in rows]))
