"""The faces of a mesh grouped by part."""

from dataclasses import dataclass

import numpy as np

from segcore.arrays import IntArray
from segcore.hierarchy import Hierarchy


@dataclass(frozen=True, slots=True, eq=False)
class Slices:
    """The input faces grouped by part, in input order within each part."""

    faces: IntArray  # (F,) input faces
    start: IntArray  # (K + 1,) part k has faces[start[k]:start[k + 1]]

    def __len__(self) -> int:
        return len(self.start) - 1

    def __getitem__(self, part: int) -> IntArray:
        """The input faces of a part."""
        return self.faces[self.start[part] : self.start[part + 1]]


def group(part_of_face: IntArray, count: int) -> Slices:
    """Group the faces by part 0..count - 1.

    Parameters
    ----------
    part_of_face : (F,).
    """
    keys = part_of_face.astype(np.uint16) if count <= 2**16 else part_of_face  # NumPy sorts 16-bit keys by radix
    order = np.argsort(keys, kind="stable").astype(np.int32)
    start = np.concatenate([[0], np.cumsum(np.bincount(part_of_face, minlength=count))]).astype(np.int32)
    return Slices(order, start)


def segment_slices(hierarchy: Hierarchy, segments: int | None = None) -> Slices:
    """Group the faces by segment of a level, by default the automatic one.

    Raises
    ------
    InvalidParameters
        If ``segments`` is not in 1..max_segments.
    """
    return group(hierarchy.labels(segments), len(hierarchy.segment_nodes(segments)))
