"""Whether congruent shells of a mesh are cut alike."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from segcore.arrays import group_sums
from segcore.cut.node_shapes import Shapes, moment_sums

if TYPE_CHECKING:
    from segcore.arrays import FloatArray, IntArray
    from segcore.mesh import Mesh

# Set by hand.
_SPECK = 0.002  # share of the area of a mesh below which a shell is not looked at
_TOLERANCE = 0.01  # of the logarithms of areas, and of standard deviations in the largest one
_INSIDE = 0.02  # share of the area of a shell from which a segment counts as one of it
_OWN = 0.95  # share of a segment in one shell from which it is a part of that shell alone


class Repeats(NamedTuple):
    """Groups of congruent shells."""

    groups: int  # of two shells or more
    unlike: int  # groups of which not all shells are cut alike


def repeats_of(mesh: Mesh, area: FloatArray, shell: IntArray, label: IntArray) -> Repeats:
    """Count the groups of congruent shells, and those that are not cut alike.

    Two shells are congruent if they have as many faces, about the same area and about the same standard deviations
    along their principal axes. They are cut alike if they have as many segments, and if both or neither have a segment
    of their own.

    Parameters
    ----------
    area, shell, label : (F,) the area, the shell 0, 1, ... and the segment of every face.
    """
    count = int(shell.max()) + 1
    sums = moment_sums(shell, area, mesh.corners.mean(axis=1), count)
    large = np.flatnonzero(sums[:, 0] >= _SPECK * sums[:, 0].sum())
    shapes = Shapes.of(sums[large])
    faces = np.bincount(shell, minlength=count)[large]
    state = _states(area, shell, label)[large]
    groups = unlike = 0
    waiting = np.ones(len(large), dtype=np.bool_)
    for first in range(len(large)):
        is_like = shapes.like(shapes.log_area[first], shapes.spread[first], _TOLERANCE, _TOLERANCE)
        members = waiting & is_like & (faces == faces[first])
        waiting &= ~members
        if np.count_nonzero(members) > 1:
            groups += 1
            unlike += len(np.unique(state[members], axis=0)) > 1
    return Repeats(groups, unlike)


def _states(area: FloatArray, shell: IntArray, label: IntArray) -> IntArray:
    """(S, 2) the number of segments of every shell, and whether the largest one is its own."""
    shells, segments = int(shell.max()) + 1, int(label.max()) + 1
    shared = group_sums(shell.astype(np.int64) * segments + label, area, shells * segments).reshape(shells, segments)
    inside = np.count_nonzero(shared >= _INSIDE * shared.sum(axis=1, keepdims=True), axis=1)
    largest = shared.argmax(axis=1)
    is_own = shared[np.arange(shells), largest] >= _OWN * shared.sum(axis=0)[largest]
    return np.stack([inside, is_own], axis=1).astype(np.int32)
