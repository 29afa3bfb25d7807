"""Procedural meshes with known parts, for demonstrations, tests, benchmarks and compiling the kernels."""

from dataclasses import dataclass

import numpy as np

from segcore.arrays import FloatArray, IntArray, transformed
from segcore.mesh import Mesh


@dataclass(frozen=True, slots=True, eq=False)
class Shape:
    """A mesh and the part 0, 1, ... of every face."""

    mesh: Mesh
    parts: IntArray  # (F,)


def icosphere(subdivisions: int = 4, radius: float = 1.0) -> Mesh:
    """A sphere of 20 * 4**subdivisions nearly equal faces around the origin."""
    golden = (1 + 5**0.5) / 2
    signs = [(s, t * golden) for s in (-1, 1) for t in (-1, 1)]
    corners = [p for s, t in signs for p in ((0.0, s, t), (s, t, 0.0), (t, 0.0, s))]
    vertices = np.array(corners) / np.hypot(1, golden)
    faces = _hull_of_icosahedron(vertices)
    for _ in range(subdivisions):
        vertices, faces = subdivide(vertices, faces)
        vertices /= np.linalg.norm(vertices, axis=1, keepdims=True)
    return Mesh(radius * vertices, faces)


def subdivide(vertices: FloatArray, faces: IntArray) -> tuple[FloatArray, IntArray]:
    """Cut every face in four at the midpoints of its edges; the quarters of face i are faces 4 i to 4 i + 3."""
    edges = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    unique, which = np.unique(edges, axis=0, return_inverse=True)
    middle = len(vertices) + which.reshape(-1, 3)
    a, b, c = faces.T
    ab, bc, ca = middle.T
    quarters = np.stack([a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca], axis=1).reshape(-1, 3)
    return np.concatenate([vertices, vertices[unique].mean(axis=1)]), quarters.astype(np.int32)


def revolve(radius: FloatArray, height: FloatArray, around: int) -> Mesh:
    """A closed surface of revolution about the z axis.

    Parameters
    ----------
    radius, height : (R,) of the rings from the lowest to the highest, each radius > 0. A pole closes either end.
    around : number of vertices on every ring.
    """
    angle = 2 * np.pi * np.arange(around) / around
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    rings = np.concatenate(
        [(radius[:, None, None] * ring), np.broadcast_to(height[:, None, None], (len(radius), around, 1))], axis=2
    )
    poles = np.array([[0, 0, height[0]], [0, 0, height[-1]]])
    index = np.arange(len(radius) * around).reshape(len(radius), around)
    after = np.roll(index, -1, axis=1)
    bottom, top = index.size, index.size + 1
    sides = np.stack([index[:-1], after[:-1], after[1:], index[:-1], after[1:], index[1:]], axis=2).reshape(-1, 3)
    low = np.stack([after[0], index[0], np.full(around, bottom)], axis=1)
    high = np.stack([index[-1], after[-1], np.full(around, top)], axis=1)
    return Mesh(np.concatenate([rings.reshape(-1, 3), poles]), np.concatenate([low, sides, high]).astype(np.int32))


def dumbbell(rings: int = 100, around: int = 48, neck: float = 0.3) -> Shape:
    """Two balls of radius 1, their centres 3 apart, and a neck between them: lower ball 0, upper ball 1, neck 2."""
    height = 2.5 * np.cos(np.linspace(np.pi, 0, rings + 2)[1:-1])
    ball = np.sqrt(np.maximum(0.0, 1 - (np.abs(height) - 1.5) ** 2))
    between = np.where(np.abs(height) < 1.5, neck, 0.0)
    mesh = revolve((ball**6 + between**6) ** (1 / 6), height, around)
    middle = mesh.corners[:, :, 2].mean(axis=1)
    return Shape(mesh, np.where(np.abs(middle) < 0.5, 2, middle > 0).astype(np.int32))


def burr(subdivisions: int = 5, arms: int = 6) -> Shape:
    """A ball with up to six round arms along the axes: part 0 is the ball, parts 1 to ``arms`` are the arms."""
    direction = np.array([sign * np.eye(3)[i] for i in range(3) for sign in (1, -1)][:arms])
    sphere = icosphere(subdivisions)
    reach = 1.6 / (1 + np.exp(60 * (0.93 - transformed(sphere.vertices, direction))))
    vertices = sphere.vertices * (1 + reach.sum(axis=1, keepdims=True))
    towards = transformed(sphere.corners.mean(axis=1), direction)
    parts = np.where(towards.max(axis=1) > 0.86, 1 + towards.argmax(axis=1), 0)
    return Shape(Mesh(vertices, sphere.faces), parts.astype(np.int32))


def box(
    size: tuple[float, float, float] = (1.0, 1.0, 1.0), centre: tuple[float, float, float] = (0.0, 0.0, 0.0)
) -> Mesh:
    """An axis-aligned box of 12 faces."""
    corner = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = [face for a, b, c, d in quads for face in ((a, b, c), (a, c, d))]
    return Mesh(corner * size + centre, np.array(faces, dtype=np.int32))


def joined(*meshes: Mesh) -> Shape:
    """One mesh of several components: part i is mesh i."""
    first = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes])
    faces = np.concatenate([mesh.faces + start for mesh, start in zip(meshes, first, strict=False)])
    parts = np.repeat(np.arange(len(meshes), dtype=np.int32), [len(mesh.faces) for mesh in meshes])
    return Shape(Mesh(np.concatenate([mesh.vertices for mesh in meshes]), faces), parts)


def _hull_of_icosahedron(vertices: FloatArray) -> IntArray:
    """(20, 3) the triples of mutually nearest vertices, counter-clockwise seen from outside."""
    near = vertices @ vertices.T > 0.4
    triples = [
        (i, j, k) for i in range(12) for j in range(i) for k in range(j) if near[i, j] and near[j, k] and near[k, i]
    ]
    outward = [(i, j, k) if np.linalg.det(vertices[[i, j, k]]) > 0 else (i, k, j) for i, j, k in triples]
    return np.array(outward, dtype=np.int32)
