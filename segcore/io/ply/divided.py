"""Vertices divided along the borders of parts, for programs that show colours of vertices only."""

from dataclasses import dataclass

import numpy as np

from segcore.arrays import IntArray
from segcore.mesh import Mesh

UNUSED = -1  # label of vertices that no face uses


@dataclass(frozen=True, slots=True, eq=False)
class DividedVertices:
    """Every vertex once for every label around it: the vertices of the mesh, then further copies of some."""

    source: IntArray  # (R,) the vertex of the mesh; the first V are 0, 1, ..., V - 1
    label: IntArray  # (R,) of the faces that use the row, -1 if there are none
    faces: IntArray  # (F, 3) rows


def divide(mesh: Mesh, labels: IntArray) -> DividedVertices:
    """Divide the vertices of a mesh between faces of different labels (F,).

    A vertex keeps its place for the label of the first face that uses it. Copies for other labels come after all
    vertices, in the order of vertices and labels.
    """
    count = len(mesh.vertices)
    label_of_corner = np.repeat(labels, 3)
    corners = mesh.faces.reshape(-1)
    label = np.full(count, UNUSED, dtype=np.int32)
    label[corners[::-1]] = label_of_corner[::-1]  # the first face is assigned last
    differs = label[corners] != label_of_corner
    keys = corners[differs].astype(np.int64) * (int(labels.max()) + 1) + label_of_corner[differs]
    copies, which = np.unique(keys, return_inverse=True)
    rows = corners.copy()
    rows[differs] = count + which
    source, of_copy = np.divmod(copies, int(labels.max()) + 1)
    return DividedVertices(
        np.concatenate([np.arange(count), source]).astype(np.int32),
        np.concatenate([label, of_copy]).astype(np.int32),
        rows.reshape(-1, 3),
    )
