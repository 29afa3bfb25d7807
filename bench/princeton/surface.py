"""The quantities of a mesh and of a segmentation that the metrics need, computed once for all comparisons."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

if TYPE_CHECKING:
    # The metrics run without segcore and its compiled kernels.
    from numpy.typing import ArrayLike

    from segcore.arrays import FloatArray, IntArray, LongArray


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """Areas, edges and size of a mesh."""

    face_area: FloatArray  # (F,) > 0 in total
    edge_graph: csr_array  # (V, V) symmetric, edge lengths
    shared_edge: LongArray  # (A, 2) the two vertices of the common edge of two adjacent faces
    adjacent_faces: LongArray  # (A, 2) these two faces
    mean_radius: float  # mean distance from the surface to its centroid, > 0

    @classmethod
    def from_mesh(cls, vertices: FloatArray, faces: IntArray) -> Surface:
        """Compute the surface of a triangle mesh.

        At an edge with more than two faces, each face is adjacent to the next one in input order, which suffices to
        find out if their labels differ.

        Parameters
        ----------
        vertices : (V, 3) coordinates in any unit.
        faces : (F, 3) indices into ``vertices``.

        Raises
        ------
        ValueError
            If the surface has no area or no extent: the metrics are not defined on it.
        """
        corners = vertices[faces]
        cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        face_area = 0.5 * np.linalg.norm(cross, axis=1)
        if not face_area.sum() > 0:
            raise ValueError("The surface has no area: segmentations of it cannot be compared.")
        shared_edge, adjacent_faces = _adjacency(faces)
        return cls(
            face_area=face_area,
            edge_graph=_edge_graph(vertices, faces),
            shared_edge=shared_edge,
            adjacent_faces=adjacent_faces,
            mean_radius=_mean_radius(corners.mean(axis=1), face_area),
        )


@dataclass(frozen=True, slots=True, eq=False)
class Segmentation:
    """One segmentation of a surface, with the distance of every vertex to its cuts."""

    label: LongArray  # (F,) contiguous 0..K - 1
    segments: int  # K
    cut_vertices: LongArray  # (C,) the ends of the edges between faces of different labels, each once
    distance_to_cut: FloatArray  # (V,) along the edges of the mesh; infinity if no path leads to a cut

    @classmethod
    def of(cls, surface: Surface, labels: ArrayLike) -> Segmentation:
        """Compute the segmentation of a surface from the labels of its faces.

        Parameters
        ----------
        labels : (F,) integers of any values; only which of them are equal matters.

        Raises
        ------
        ValueError
            If there is not one label for every face.
        """
        values = np.asarray(labels)
        if values.shape != surface.face_area.shape:
            raise ValueError(f"There must be one label for each of {len(surface.face_area)} faces, not {values.shape}.")
        names, label = np.unique(values, return_inverse=True)
        cut = label[surface.adjacent_faces[:, 0]] != label[surface.adjacent_faces[:, 1]]
        cut_vertices = np.unique(surface.shared_edge[cut])
        return cls(
            label=label,
            segments=len(names),
            cut_vertices=cut_vertices,
            distance_to_cut=_distance_to(cut_vertices, surface.edge_graph),
        )


def _half_edges(faces: IntArray) -> LongArray:
    """(3 F, 2) vertices of the sides of the faces, face by face, the smaller index first."""
    return np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2).astype(np.int64), axis=1)


def _adjacency(faces: IntArray) -> tuple[LongArray, LongArray]:
    half_edges = _half_edges(faces)
    order = np.lexsort((half_edges[:, 1], half_edges[:, 0]))
    half_edges = half_edges[order]
    face = order // 3
    same_edge = (half_edges[1:] == half_edges[:-1]).all(axis=1)
    return half_edges[1:][same_edge], np.column_stack([face[:-1][same_edge], face[1:][same_edge]])


def _edge_graph(vertices: FloatArray, faces: IntArray) -> csr_array:
    # Each edge once, because a sparse matrix sums repeated entries. An edge of length 0 stays an edge.
    edges = np.unique(_half_edges(faces), axis=0)
    start, end = edges[edges[:, 0] < edges[:, 1]].T
    length = np.linalg.norm(vertices[start] - vertices[end], axis=1)
    rows, columns = np.concatenate([start, end]), np.concatenate([end, start])
    return csr_array((np.tile(length, 2), (rows, columns)), shape=(len(vertices), len(vertices)))


def _mean_radius(face_centre: FloatArray, face_area: FloatArray) -> float:
    centroid = np.average(face_centre, axis=0, weights=face_area)
    return float(np.average(np.linalg.norm(face_centre - centroid, axis=1), weights=face_area))


def _distance_to(sources: LongArray, edge_graph: csr_array) -> FloatArray:
    if len(sources) == 0:
        return np.full(edge_graph.shape[0], np.inf)
    distance: FloatArray = dijkstra(edge_graph, indices=sources, min_only=True)
    return distance
