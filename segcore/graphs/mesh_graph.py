"""A graph of the faces or vertices of a surface, with what the method needs to know of its nodes."""

from dataclasses import dataclass

from segcore.arrays import FloatArray, IntArray
from segcore.graphs.surface_graph import SurfaceGraph


@dataclass(frozen=True, slots=True, eq=False)
class MeshGraph:
    """A graph of the faces or vertices of a surface."""

    graph: SurfaceGraph
    points: FloatArray  # (N, 3) where the nodes are
    corners: IntArray  # (F, C) the nodes of every face: itself, or its three vertices
    thickness: FloatArray | None = None  # (N,) logarithm of the shape diameter over sqrt(total area)
