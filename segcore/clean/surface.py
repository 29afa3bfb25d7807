"""The cleaned surface that the method works on, and the map from its faces to those of the input.

Every mesh can be cleaned. Vertices at the same place, at open borders also within a tolerance, are welded. Faces that
lose a corner by that, and repeated faces, are left out and represented by another face. Patches that meet across cracks
and at T-junctions are stitched. Faces are flipped so that neighbours agree and closed parts face outward.
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import KDTree

from segcore.array_kernels import face_centroids
from segcore.arrays import BoolArray, FloatArray, IntArray, group_sums
from segcore.clean.orientation import flipped, patch_volumes, reliable_normals
from segcore.clean.slivers import with_borrowed_normals
from segcore.clean.solids import with_solids_apart
from segcore.clean.stitching import stitch
from segcore.clean.topology import DualEdges, consistent_orientation, dual_edges, first_equal_row, sorted_rows
from segcore.clean.welding import weld
from segcore.graphs.surface_graph import SurfaceGraph, rows_of
from segcore.mesh import Mesh

# An open patch is flipped if its enclosed volume over area**1.5 is below minus this; a ball has 0.094. Set by hand: an
# open sheet encloses next to nothing and keeps the orientation of the file.
_CLEARLY_INSIDE_OUT = 0.01


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """Welded, consistently oriented faces scaled to a bounding box of extent 1, and their dual edges."""

    vertices: FloatArray  # (V, 3)
    faces: IntArray  # (F, 3)
    normals: FloatArray  # (F, 3) unit normals; those of slivers are borrowed, zero if no other face is connected
    areas: FloatArray  # (F,)
    edge_faces: IntArray  # (E, 2) the two faces at a dual edge
    edge_vertices: IntArray  # (E, 2) the two ends of the mesh edge, or part of one at a T-junction, that it crosses
    face_of_input: IntArray  # (F_input,) the face that represents every input face
    unit: float  # length of one unit here, in units of the input
    is_flipped: BoolArray  # (F,) the face has the opposite orientation in the input
    stitched_edges: int = 0  # open edges that were joined across cracks and T-junctions
    stitched_gap: float = 0.0  # the widest gap between two of them
    authored: IntArray | None = None  # (F,) the part of the structure of the file, if the cuts follow it

    def face_graph(self) -> SurfaceGraph:
        """The face dual graph with weights and lengths 1 and the areas as volumes."""
        ones = np.ones(len(self.edge_faces))
        return SurfaceGraph(self.edge_faces, ones, self.areas, ones)


def build_surface(mesh: Mesh) -> Surface:
    """Clean a mesh.

    If no face has three different corners, the surface consists of the first face, which represents all others.
    """
    positions, corners = _compacted(mesh.vertices, mesh.faces)
    unit, scaled = _normalized(positions)
    corners = weld(positions, corners)[corners]
    kept, representative = distinct_faces(corners)
    if len(kept) < len(corners):
        apart, scaled = with_solids_apart(corners, scaled)
        if apart is not corners:
            corners = apart
            kept, representative = distinct_faces(corners)
    vertices, faces = _compacted(scaled, corners[kept])
    joined = stitch(vertices, faces, dual_edges(faces, len(vertices)))
    vertices, dual = joined.vertices, joined.dual
    is_flipped = _turned(vertices, joined.faces, dual)
    faces = flipped(joined.faces, is_flipped)
    normals, areas = reliable_normals(vertices, faces)
    normals = with_borrowed_normals(normals, dual, vertices)
    face_of_input = _with_lost_faces(representative, corners, scaled)
    return Surface(
        vertices,
        faces,
        normals,
        areas,
        dual.faces,
        dual.vertices,
        face_of_input,
        unit,
        is_flipped,
        joined.edges,
        joined.gap,
    )


def _normalized(vertices: FloatArray) -> tuple[float, FloatArray]:
    """The extent of the bounding box, 1 if it is 0, and vertices centred and scaled to the extent 1."""
    low, high = (np.array([find(axis) for axis in vertices.T]) for find in (np.min, np.max))
    unit = float((high - low).max()) or 1.0
    return unit, (vertices - (0.5 * low + 0.5 * high)) / unit


def _compacted(positions: FloatArray, faces: IntArray) -> tuple[FloatArray, IntArray]:
    """The positions that some face uses, and the faces with indices into them."""
    used = np.zeros(len(positions), dtype=bool)
    used[faces] = True
    if used.all():
        return positions, faces
    return positions[used], (np.cumsum(used, dtype=np.int32) - 1)[faces]


def distinct_faces(corners: IntArray) -> tuple[IntArray, IntArray]:
    """The faces that are kept, and the index among them that represents every face, -1 if it has lost a corner."""
    a, b, c = corners.T
    proper = (a != b) & (b != c) & (c != a)
    candidates = np.flatnonzero(proper)
    first = first_equal_row(sorted_rows(corners, candidates))
    is_first = first == np.arange(len(first))
    position = np.cumsum(is_first) - 1
    representative = np.full(len(corners), -1, dtype=np.int32)
    representative[candidates] = position[first]
    if len(candidates) == 0:
        representative[0] = 0
        return np.zeros(1, dtype=np.int32), representative
    return candidates[is_first].astype(np.int32), representative


def _with_lost_faces(representative: IntArray, corners: IntArray, positions: FloatArray) -> IntArray:
    """(F,) representatives in which every face that has lost a corner (entry -1) gets that of a nearby face.

    The first kept face at one of its remaining edges is chosen; if there is none, the first one at one of its corners;
    else the one with the nearest centroid.
    """
    lost = np.flatnonzero(representative < 0)
    if len(lost) == 0:
        return representative
    kept = np.flatnonzero(representative >= 0)
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
    complete = representative.copy()
    for f, fallback in zip(lost.tolist(), nearest.tolist(), strict=True):
        of_edge = [at_edge[tuple(edge)] for edge in edges[f].tolist() if tuple(edge) in at_edge]
        of_corner = [at_corner[corner] for corner in corners[f].tolist() if corner in at_corner]
        complete[f] = representative[(of_edge or of_corner or [fallback])[0]]
    return complete


def _turned(vertices: FloatArray, faces: IntArray, dual: DualEdges) -> BoolArray:
    """(F,) True for faces to flip so that each patch agrees within itself and encloses a positive volume.

    A patch that encloses next to nothing keeps the orientation that most of its area has.
    """
    patch, is_flipped = consistent_orientation(rows_of(dual.faces, len(faces)), dual)
    area, volume = patch_volumes(vertices, faces, patch, is_flipped, int(patch.max()) + 1)
    clear = _CLEARLY_INSIDE_OUT * np.maximum(area, np.finfo(float).tiny) ** 1.5
    inside_out = volume < -clear
    if is_flipped.any():
        flipped_area = group_sums(patch, reliable_normals(vertices, faces)[1] * is_flipped)
        inside_out |= (np.abs(volume) <= clear) & (2.0 * flipped_area > area)
    turned: BoolArray = is_flipped != inside_out[patch]
    return turned
