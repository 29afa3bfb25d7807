"""Makes clusters of faces connected."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

if TYPE_CHECKING:
    from bench.princeton.surface import Surface
    from segcore.arrays import FloatArray, IntArray, LongArray


def keep_largest_pieces(vertices: FloatArray, surface: Surface, cluster: LongArray) -> IntArray:
    """Keep only the largest connected piece of every cluster, by area.

    Every other piece joins the segment with which it has the longest border; pieces that touch a segment join first. A
    piece without a path to any segment keeps its cluster.

    Parameters
    ----------
    vertices : (V, 3) of the surface.
    cluster : (F,) cluster of every face, >= 0.

    Returns
    -------
    (F,) new cluster of every face.
    """
    piece = _pieces(surface, cluster)
    pieces = int(piece.max()) + 1
    cluster_of_piece = np.empty(pieces, dtype=np.int32)
    cluster_of_piece[piece] = cluster
    label = _largest_only(cluster_of_piece, np.bincount(piece, surface.face_area).astype(np.float64))
    border = _borders(vertices, surface, piece)
    while (label < 0).any():
        joined = _join_neighbours(label, border)
        if np.array_equal(joined, label):
            break
        label = joined
    labels: IntArray = np.where(label < 0, cluster_of_piece, label)[piece]
    return labels


def _pieces(surface: Surface, cluster: LongArray) -> IntArray:
    """(F,) connected piece 0, 1, ... of every face."""
    one, other = surface.adjacent_faces.T
    inside = cluster[one] == cluster[other]
    shape = (len(cluster), len(cluster))
    graph = coo_array((np.ones(inside.sum()), (one[inside], other[inside])), shape=shape)
    piece: IntArray = connected_components(graph, directed=False)[1]
    return piece


def _largest_only(cluster_of_piece: IntArray, area: FloatArray) -> IntArray:
    """(P,) cluster of every piece that is the largest of its cluster, -1 for all others."""
    label = np.full(len(area), -1, dtype=np.int32)
    order = np.argsort(-area, kind="stable")
    clusters, first = np.unique(cluster_of_piece[order], return_index=True)
    label[order[first]] = clusters
    return label


def _borders(vertices: FloatArray, surface: Surface, piece: IntArray) -> coo_array:
    """(P, P) length of the border between two pieces, symmetric."""
    start, end = surface.shared_edge.T
    length = np.linalg.norm(vertices[start] - vertices[end], axis=1)
    one, other = piece[surface.adjacent_faces].T
    across = one != other
    rows, columns = np.concatenate([one[across], other[across]]), np.concatenate([other[across], one[across]])
    pieces = int(piece.max()) + 1
    border = coo_array((np.tile(length[across], 2), (rows, columns)), shape=(pieces, pieces))
    border.sum_duplicates()
    return border


def _join_neighbours(label: IntArray, border: coo_array) -> IntArray:
    """Label every unlabelled piece that touches labelled ones with the label on most of its border."""
    rows, columns = border.coords
    open_border = (label[rows] < 0) & (label[columns] >= 0)
    shared = np.zeros((len(label), int(label.max()) + 1))
    np.add.at(shared, (rows[open_border], label[columns[open_border]]), border.data[open_border])
    touches = np.zeros(len(label), dtype=bool)
    touches[rows[open_border]] = True
    joined = label.copy()
    joined[touches] = np.argmax(shared[touches], axis=1)
    return joined
