"""The cleaned surface that the method works on, and the way back from it to the faces of the input.

Nothing is refused here. Vertices at the same place, at open borders also within a tolerance, are welded; faces that
lose a corner by that, and repeated faces, are left out and follow a face that stands for them; faces are turned so that
neighbours agree and closed parts face outward.
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import KDTree

from segcore.arrays import BoolArray, FloatArray, IntArray
from segcore.clean.orientation import patch_volumes, reliable_normals, turned_round
from segcore.clean.topology import consistent_orientation, dual_edges, first_equal_row
from segcore.clean.welding import weld
from segcore.graphs.surface_graph import SurfaceGraph, rows_of
from segcore.mesh import Mesh, face_centroids

_CLEARLY_INSIDE_OUT = 0.01  # enclosed volume over area**1.5 from which an open patch is turned round


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """Welded, consistently oriented faces scaled to a bounding box of extent 1, and their dual edges."""

    vertices: FloatArray  # (V, 3)
    faces: IntArray  # (F, 3)
    normals: FloatArray  # (F, 3) unit normals, zero for slivers without a reliable direction
    areas: FloatArray  # (F,)
    edge_faces: IntArray  # (E, 2) the two faces at a dual edge
    edge_vertices: IntArray  # (E, 2) the two vertices of the mesh edge that it crosses
    face_of_input: IntArray  # (F_input,) the face that stands for every input face
    unit: float  # length of one unit here, in units of the input

    def face_graph(self) -> SurfaceGraph:
        """The face dual graph with all weights and lengths 1 and the areas as volumes."""
        ones = np.ones(len(self.edge_faces))
        return SurfaceGraph(self.edge_faces, ones, self.areas, ones)


def build_surface(mesh: Mesh) -> Surface:
    """Clean a mesh. Where no face has three different corners, the first face stands for all."""
    unit, scaled = _normalized(mesh.vertices)
    corners = weld(mesh.vertices, mesh.faces)[mesh.faces]
    kept, stands_for = _distinct_faces(corners)
    vertices, faces = _compacted(scaled, corners[kept])
    edge_faces, edge_vertices, manifold, disagree = dual_edges(faces, len(vertices))
    faces = _oriented(vertices, faces, edge_faces, manifold, disagree)
    normals, areas = reliable_normals(vertices, faces)
    follow_neighbours(stands_for, corners, scaled)
    return Surface(vertices, faces, normals, areas, edge_faces, edge_vertices, stands_for, unit)


def _normalized(vertices: FloatArray) -> tuple[float, FloatArray]:
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    unit = float((high - low).max()) or 1.0
    return unit, (vertices - (0.5 * low + 0.5 * high)) / unit


def _compacted(positions: FloatArray, faces: IntArray) -> tuple[FloatArray, IntArray]:
    used = np.zeros(len(positions), dtype=bool)
    used[faces] = True
    return positions[used], (np.cumsum(used, dtype=np.int32) - 1)[faces]


def _distinct_faces(corners: IntArray) -> tuple[IntArray, IntArray]:
    """The faces that are kept, and for every face the position of its stand-in among them; -1: it has lost a corner."""
    a, b, c = corners.T
    proper = (a != b) & (b != c) & (c != a)
    candidates = np.flatnonzero(proper)
    first = first_equal_row(np.sort(corners[candidates], axis=1).astype(np.int64))
    is_first = first == np.arange(len(first))
    position = np.cumsum(is_first) - 1
    stands_for = np.full(len(corners), -1, dtype=np.int32)
    stands_for[candidates] = position[first]
    if len(candidates) == 0:
        stands_for[0] = 0
        return np.zeros(1, dtype=np.int32), stands_for
    return candidates[is_first].astype(np.int32), stands_for


def follow_neighbours(stands_for: IntArray, corners: IntArray, positions: FloatArray) -> None:
    """Let every face that has lost a corner (entry -1) follow the face nearest to it, in place.

    Its remaining corners are compared with the corners of the kept faces: a kept face at the same edge wins over one at
    the same corner, and that over the nearest centroid.
    """
    lost = np.flatnonzero(stands_for < 0)
    if len(lost) == 0:
        return
    kept = np.flatnonzero(stands_for >= 0)
    edges = np.sort(corners[:, [[0, 1], [1, 2], [2, 0]]], axis=2)
    at_edge = {}
    at_corner = {}
    touched = np.zeros(len(positions), dtype=bool)
    touched[corners[lost]] = True
    for f in kept[touched[corners[kept]].any(axis=1)][::-1].tolist():
        at_edge.update({tuple(edge): f for edge in edges[f].tolist()})
        at_corner.update(dict.fromkeys(corners[f].tolist(), f))
    centroids = face_centroids(positions, corners)
    nearest = kept[KDTree(centroids[kept]).query(centroids[lost])[1]]
    for f, fallback in zip(lost.tolist(), nearest.tolist(), strict=True):
        of_edge = [at_edge[tuple(edge)] for edge in edges[f].tolist() if tuple(edge) in at_edge]
        of_corner = [at_corner[corner] for corner in corners[f].tolist() if corner in at_corner]
        stands_for[f] = stands_for[(of_edge or of_corner or [fallback])[0]]


def _oriented(
    vertices: FloatArray, faces: IntArray, edge_faces: IntArray, manifold: BoolArray, disagree: BoolArray
) -> IntArray:
    """Faces turned so that each patch agrees within itself and encloses a positive volume."""
    rows = rows_of(edge_faces, len(faces))
    patch, turned = consistent_orientation(rows.start, rows.neighbour, rows.edge, manifold, disagree)
    area, volume = patch_volumes(vertices, faces, patch, turned, int(patch.max()) + 1)
    inside_out = volume < -_CLEARLY_INSIDE_OUT * np.maximum(area, np.finfo(float).tiny) ** 1.5
    return turned_round(faces, turned != inside_out[patch])
