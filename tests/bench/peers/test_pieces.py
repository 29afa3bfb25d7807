"""Clusters of faces are made connected."""

import numpy as np

from bench.peers.pieces import keep_largest_pieces
from bench.princeton.surface import Surface
from helpers.bench.strips import cut_at, strip


def test_an_isolated_piece_joins_the_segment_with_the_longest_border() -> None:
    # Three rows: the isolated square of cluster 0 in row 1 touches cluster 1 on three sides, cluster 2 on one.
    columns, rows = 5, 3
    vertices, faces = strip(columns, rows)
    square = np.ones((columns, rows), dtype=np.int64)
    square[:, 2] = 2
    square[0] = 0
    square[3, 1] = 0
    expected = square.copy()
    expected[3, 1] = 1
    cleaned = keep_largest_pieces(vertices, Surface.from_mesh(vertices, faces), np.repeat(square.ravel(), 2))
    assert np.array_equal(cleaned, np.repeat(expected.ravel(), 2))


def test_pieces_between_isolated_pieces_join_after_them() -> None:
    # Clusters 0 and 1 keep their first pieces. The isolated columns 7 and 9 touch 1 and 2; column 8 only 7 and 9.
    labels = np.array([0, 0, 0, 0, 1, 1, 1, 0, 1, 0, 2, 2])
    vertices, faces = strip(len(labels))
    cleaned = keep_largest_pieces(vertices, Surface.from_mesh(vertices, faces), np.repeat(labels, 2))
    assert np.array_equal(cleaned[::2], [0, 0, 0, 0, 1, 1, 1, 1, 1, 2, 2, 2])


def test_connected_clusters_are_not_changed() -> None:
    labels = cut_at(12, 4, 9)
    vertices, faces = strip(12)
    assert np.array_equal(keep_largest_pieces(vertices, Surface.from_mesh(vertices, faces), labels), labels)
