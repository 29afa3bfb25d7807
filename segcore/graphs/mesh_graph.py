"""A graph of the faces or vertices of a surface, with the positions and the thickness of its nodes."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from segcore.arrays import FloatArray, IntArray
from segcore.graphs.surface_graph import SurfaceGraph


class Opposites(NamedTuple):
    """Pairs of nodes on opposite faces of a body, as rays into it find them."""

    nodes: IntArray  # (M, 2)
    distance: FloatArray  # (M,) > 0
    area: FloatArray  # (M,) that a ray stands for


@dataclass(frozen=True, slots=True, eq=False)
class MeshGraph:
    """A graph whose nodes are the faces of a surface, or its vertices."""

    graph: SurfaceGraph
    points: FloatArray  # (N, 3) positions of the nodes
    corners: IntArray | None  # (F, 3) the nodes at the corners of every face; None if the nodes are the faces
    thickness: FloatArray | None = None  # (N,) logarithm of the shape diameter over sqrt(total area); None if unknown
    confidence: FloatArray | None = None  # (N,) share of the rays that met the other side from inside; None if unknown
    authored: IntArray | None = None  # (N,) the part of the structure of the file, if the cuts follow it
    grain: IntArray | None = None  # (N,) groups of nodes to begin a coarsening with, if the mesh is fine
    opposites: Opposites | None = None  # None if the thickness was not measured

    @property
    def of_face(self) -> IntArray:
        """(F,) a node of every face: the face itself, or its first corner."""
        return np.arange(self.graph.node_count, dtype=np.int32) if self.corners is None else self.corners[:, 0]
