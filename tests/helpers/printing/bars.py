"""Boxes of several parts along x, which are cut by planes, for the tests of files for printing."""

import numpy as np
import trimesh

from helpers.printing.solids import halves
from segcore.coordinates import Coordinates
from segcore.hierarchy import Hierarchy
from segcore.mesh import Mesh

IN_MM = Coordinates("millimeter", "z")


def bar(length: float = 60.0, width: float = 20.0, coordinates: Coordinates = IN_MM) -> tuple[Mesh, Hierarchy]:
    """A closed bar along x from 0 and its two halves, whose contact is a square of this width."""
    box = trimesh.creation.box((length, width, width))
    for _ in range(2):
        box = box.subdivide()
    mesh = Mesh(box.vertices - box.bounds[0], box.faces, coordinates=coordinates)
    return mesh, halves(mesh, mesh.corners[:, :, 0].mean(axis=1) < length / 2)


def bent_bar() -> tuple[Mesh, Hierarchy]:
    """The bar with a border between its halves that leaves every plane by a quarter of the length."""
    mesh, _ = bar()
    centres = mesh.corners.mean(axis=1)
    return mesh, halves(mesh, centres[:, 0] < np.where(centres[:, 1] < 10.0, 15.0, 45.0))
