"""The shape of a part as it is compared with others: its moments, its box, and points on it."""

from functools import cached_property

import numpy as np

from segcore.array_kernels import area_moments
from segcore.arrays import FloatArray, IntArray
from segcore.mesh import face_normals_and_areas
from segcore.part_list.boxes import OrientedBox, extreme_places
from segcore.part_list.surface_distance import SurfaceDistance, spread_anchors

# Set by hand: 512 points are 1 / 23 of the size apart, and the extreme vertices are the corners.
_SPREAD, _EXTREME = 512, 64


class PartShape:
    """The faces of a part around the centroid of their area, in units of the mesh.

    Parameters
    ----------
    vertices : (V, 3) in the coordinates of the mesh.
    faces : (F, 3), of which at least one has an area.
    box : around the vertices.
    """

    def __init__(self, vertices: FloatArray, faces: IntArray, box: OrientedBox) -> None:
        around = vertices - box.centre
        areas = face_normals_and_areas(around[faces])[1]
        centroid, moments = area_moments(around, faces, areas)
        self.area = float(areas.sum())
        self.centre = box.centre + centroid
        self.vertices, self.faces, self.box = around - centroid, faces, box
        self.size = box.diagonal
        values, vectors = np.linalg.eigh(moments)
        self.spread: FloatArray = np.sqrt(np.maximum(values, 0.0))  # (3,) ascending
        self.axes: FloatArray = vectors.T  # (3, 3) principal axes of the area, as rows
        self.reach = float(np.linalg.norm(self.vertices, axis=1).max())

    @cached_property
    def points(self) -> FloatArray:
        """(P, 3) points spread evenly over the area, then extreme vertices."""
        areas = face_normals_and_areas(self.vertices[self.faces])[1]
        spread = spread_anchors(self.vertices, self.faces, areas, _SPREAD).points
        return np.concatenate([spread, self.vertices[extreme_places(self.vertices, _EXTREME)]])

    @cached_property
    def distance(self) -> SurfaceDistance:
        """Distances of other points from the faces."""
        return SurfaceDistance(self.vertices, self.faces)
