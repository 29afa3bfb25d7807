"""Meshes for the tests of robots, in metres."""

import numpy as np
import trimesh

from segcore.coordinates import Coordinates
from segcore.hierarchy import Hierarchy
from segcore.mesh import Mesh
from segcore.partition import Partition

METRES = Coordinates("meter", "z")


def angle() -> tuple[Mesh, Hierarchy]:
    """One part: two walls at a right angle, 2 wide and high and 0.2 thick, of length 1."""
    outline = np.array([[0, 0], [2, 0], [2, 0.2], [0.2, 0.2], [0.2, 2], [0, 2]])
    half = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]]
    side = [[k, (k + 1) % 6, 6 + (k + 1) % 6] for k in range(6)] + [[k, 6 + (k + 1) % 6, 6 + k] for k in range(6)]
    faces = [[a, c, b] for a, b, c in half] + [[a + 6, b + 6, c + 6] for a, b, c in half] + side
    vertices = np.concatenate([np.column_stack([outline, np.full(6, height)]) for height in (0.0, 1.0)])
    mesh = Mesh(vertices, faces, coordinates=METRES)
    return mesh, Partition(np.zeros(len(faces), dtype=np.int32)).hierarchy(mesh)


def table() -> tuple[Mesh, Hierarchy]:
    """A plate of 1 m and four legs of 0.7 m that touch it, five bodies."""
    legs = [(x, y) for x in (0.05, 0.85) for y in (0.05, 0.85)]
    shapes = [trimesh.creation.box(bounds=[(0, 0, 0.7), (1, 1, 0.8)])]
    shapes += [trimesh.creation.box(bounds=[(x, y, 0), (x + 0.1, y + 0.1, 0.7)]) for x, y in legs]
    joined = trimesh.util.concatenate(shapes)
    mesh = Mesh(joined.vertices, joined.faces, coordinates=METRES)
    return mesh, Partition(np.arange(5).repeat(12)).hierarchy(mesh)
