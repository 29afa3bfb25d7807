"""Flat strips of triangles, on which every metric can be worked out by hand, and a segmenter for them.

A module of its own, under a name of its own, because other processes import the segmenter.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.errors import BenchmarkError
from bench.princeton.surface import Surface
from segcore.mesh import Mesh


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


def cut_at(columns: int, *positions: int, rows: int = 1) -> NDArray[np.int64]:
    """Labels (2 columns rows,) of a strip that is cut across at these columns."""
    return np.searchsorted(np.array(sorted(positions)), np.repeat(np.arange(columns), 2 * rows), side="right")


@dataclass(frozen=True)
class EvenLevels:
    """Cuts a strip across into parts of equal length."""

    columns: int
    max_segments: int
    offset: int
    automatic: int = 2

    def labels(self, segments: int | None = None) -> NDArray[np.int32]:
        count = segments or self.automatic
        positions = [self.offset + self.columns * i // count for i in range(1, count)]
        return cut_at(self.columns, *positions).astype(np.int32)


@dataclass(frozen=True)
class EvenSegmenter:
    """Puts the cuts as many columns off as the seed says."""

    max_segments: int = 6
    broken: bool = False

    def warm_up(self) -> None:
        pass

    def __call__(self, mesh: Mesh, seed: int) -> EvenLevels:
        if self.broken:
            raise BenchmarkError("the method gave up.")
        return EvenLevels(len(mesh.faces) // 2, self.max_segments, offset=seed)
