"""Copies among the authored parts of assets, found by their vertices: another way than that of segcore."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from segcore.arrays import FloatArray, IntArray
    from segcore.mesh import Mesh
    from segcore.part_list.repeats import Repeats

_SAME = 1e-4  # of the size: rounding in files of float32, with a margin. Set by hand
Pair = tuple[int, int]


def same_vertices(mesh: Mesh, labels: IntArray) -> set[Pair]:
    """Return the pairs of parts with as many vertices and faces, and these at equal distances from their mean.

    Nearly all of them are copies of each other, as they were pasted in the file, or mirrored.
    """
    known: dict[Pair, list[tuple[int, FloatArray]]] = {}
    for part in range(int(labels.max()) + 1):
        faces = mesh.faces[labels == part]
        points = mesh.vertices[np.unique(faces)]
        distances = np.sort(np.linalg.norm(points - points.mean(axis=0), axis=1))
        known.setdefault((len(points), len(faces)), []).append((part, distances))
    return {
        (first, second)
        for alike in known.values()
        for (first, here), (second, there) in combinations(alike, 2)
        if np.abs(here - there).max() <= _SAME * max(here[-1], there[-1]) > 0
    }


def grouped(repeats: Repeats) -> set[Pair]:
    """Return the pairs of parts that are in one group."""
    return {pair for group in repeats.groups for pair in combinations(group.parts, 2)}
