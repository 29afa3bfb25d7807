"""Flat strips of triangles, on which every metric can be worked out by hand."""

import numpy as np
from numpy.typing import NDArray

from bench.surface import Surface


def strip(columns: int, rows: int = 1) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Vertices and faces of a grid of unit squares, each of two triangles: square by square, column by column."""
    x, y = np.meshgrid(np.arange(columns + 1), np.arange(rows + 1), indexing="ij")
    vertices = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)]).astype(np.float64)
    corner = (np.arange(columns)[:, None] * (rows + 1) + np.arange(rows)).ravel()
    right = corner + rows + 1
    pairs = [np.column_stack([corner, right, right + 1]), np.column_stack([corner, right + 1, corner + 1])]
    return vertices, np.stack(pairs, axis=1).reshape(-1, 3).astype(np.int32)


def strip_surface(columns: int, rows: int = 1) -> Surface:
    return Surface.from_mesh(*strip(columns, rows))


def cut_at(columns: int, *positions: int) -> NDArray[np.int64]:
    """Labels (2 columns,) of a strip of one row that is cut across at these columns."""
    return np.searchsorted(np.array(sorted(positions)), np.arange(2 * columns) // 2, side="right")
