"""A simulated person who marks faces until a part is right.

The first click is at the middle of the part, the face farthest from its border. Each next one is at the middle of the
largest connected region that is wrong.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from segcore.array_kernels import face_centroids
from segcore.arrays import group_sums
from segcore.edit.distances import distances_from_border
from segcore.graphs.surface_graph import Rows, connected_components, rows_of

if TYPE_CHECKING:
    from segcore.arrays import BoolArray, FloatArray, IntArray, LongArray
    from segcore.clean.surface import Surface
    from segcore.mesh import Mesh

LEAST_SHARE = 0.01  # of the total area: smaller parts are not asked for


@dataclass(frozen=True, slots=True, eq=False)
class Shape:
    """The faces of a cleaned surface: what a person sees of a mesh."""

    edges: IntArray  # (E, 2) faces that share an edge
    rows: Rows
    step: FloatArray  # (E,) distance of their centres
    points: FloatArray  # (F, 3) centres of the faces
    area: FloatArray  # (F,)
    input_face: IntArray  # (F,) a face of the mesh that each of them represents

    @classmethod
    def of(cls, mesh: Mesh, surface: Surface) -> Shape:
        points = face_centroids(surface.vertices, surface.faces)
        edges = surface.edge_faces
        input_face = np.empty(len(points), dtype=np.int32)
        input_face[surface.face_of_input[::-1]] = np.arange(len(mesh.faces), dtype=np.int32)[::-1]
        step = np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)
        return cls(edges, rows_of(edges, len(points)), step, points, surface.areas, input_face)

    def wanted_parts(self, labels: LongArray) -> list[BoolArray]:
        """The parts (F,) of a segmentation of the mesh that have more than 1 % of the area; negative: no part."""
        own = labels[self.input_face]
        parts = [own == label for label in np.unique(own[own >= 0])]
        return [part for part in parts if self.area[part].sum() > LEAST_SHARE * self.area.sum()]

    def middle(self, region: BoolArray) -> int:
        """The face of a region that is farthest from its border; if it has none, the face nearest to its centre."""
        away = distances_from_border(self.rows, self.step, region, np.inf)
        inside = np.flatnonzero(region & np.isfinite(away))
        if len(inside):
            return int(inside[np.argmax(away[inside])])
        faces = np.flatnonzero(region)
        centre = np.average(self.points[faces], axis=0, weights=self.area[faces] + 1e-30)
        return int(faces[np.argmin(((self.points[faces] - centre) ** 2).sum(axis=1))])

    def iou(self, found: BoolArray, wanted: BoolArray) -> float:
        """Intersection over union by area."""
        union = float(self.area[found | wanted].sum())
        return float(self.area[found & wanted].sum()) / union if union > 0.0 else 0.0

    def next_click(self, found: BoolArray, wanted: BoolArray) -> int | None:
        """The middle of the largest region that is missing or too much; None if there is none."""
        regions = [self._largest(region) for region in (wanted & ~found, found & ~wanted) if region.any()]
        if not regions:
            return None
        return self.middle(max(regions, key=lambda region: float(self.area[region].sum())))

    def _largest(self, region: BoolArray) -> BoolArray:
        """(F,) the connected component of a region with the largest area."""
        component = connected_components(self.edges[region[self.edges].all(axis=1)], len(region))
        area = group_sums(component, self.area * region)
        largest: BoolArray = region & (component == int(np.argmax(area)))
        return largest
