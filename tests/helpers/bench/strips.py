"""Flat strips of triangles, on which every metric can be computed by hand, and a segmenter for them.

The segmenter is in a module, not in a test, because other processes import it.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bench.errors import BenchmarkError
from bench.princeton.surface import Surface
from segcore.mesh import Mesh


def strip(columns: int, rows: int = 1) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Return vertices and faces of a grid of unit squares of two triangles: square by square, column by column."""
    x, y = np.meshgrid(np.arange(columns + 1), np.arange(rows + 1), indexing="ij")
    vertices = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)]).astype(np.float64)
    corner = (np.arange(columns)[:, None] * (rows + 1) + np.arange(rows)).ravel()
    right = corner + rows + 1
    pairs = [np.column_stack([corner, right, right + 1]), np.column_stack([corner, right + 1, corner + 1])]
    return vertices, np.stack(pairs, axis=1).reshape(-1, 3).astype(np.int32)


def strip_surface(columns: int, rows: int = 1) -> Surface:
    """Return the surface of a strip."""
    return Surface.from_mesh(*strip(columns, rows))


def cut_at(columns: int, *positions: int, rows: int = 1) -> NDArray[np.int64]:
    """(2 columns rows,) labels of a strip that is cut across at these columns."""
    return np.searchsorted(np.array(sorted(positions)), np.repeat(np.arange(columns), 2 * rows), side="right")


STRIP_COLUMNS = 12
# Two categories of different size, so that the mean over models and the mean over categories differ.
STRIP_CATEGORIES = {1: "Rod", 3: "Rod", 21: "Slat"}
STRIP_PEOPLE = (cut_at(STRIP_COLUMNS, 4, 8), cut_at(STRIP_COLUMNS, 4, 9), cut_at(STRIP_COLUMNS, 6))


def write_strips(folder: Path) -> Path:
    """Write a benchmark of three equal strips, which three people cut into 3, 3 and 2 parts."""
    (folder / "off").mkdir(parents=True)
    vertices, faces = strip(STRIP_COLUMNS)
    lines = ["OFF", f"{len(vertices)} {len(faces)} 0", *(f"{x} {y} {z}" for x, y, z in vertices)]
    lines += [f"3 {a} {b} {c}" for a, b, c in faces]
    for number in STRIP_CATEGORIES:
        (folder / "off" / f"{number}.off").write_text("\n".join(lines) + "\n")
        people = folder / "seg" / "Benchmark" / str(number)
        people.mkdir(parents=True)
        for person, labels in enumerate(STRIP_PEOPLE):
            np.savetxt(people / f"{number}_{person}.seg", labels, fmt="%d")
    rows = [f"{number}\t{category}\t3" for number, category in STRIP_CATEGORIES.items()]
    (folder / "segments.tsv").write_text("\n".join(["model\tcategory\tsegments", *rows]) + "\n")
    return folder


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
    """Shifts the cuts by as many columns as the value of the seed."""

    max_segments: int = 6
    broken: bool = False

    def warm_up(self) -> None:
        pass

    def __call__(self, mesh: Mesh, seed: int) -> EvenLevels:
        if self.broken:
            raise BenchmarkError("the method gave up.")
        return EvenLevels(len(mesh.faces) // 2, self.max_segments, offset=seed)
