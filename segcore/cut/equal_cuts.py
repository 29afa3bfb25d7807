"""Equal cuts: congruent parts are cut off alike, wherever they are and in whatever pose."""

from collections.abc import Sequence
from math import log
from typing import NamedTuple

import numpy as np

from segcore.arrays import BoolArray, FloatArray, IntArray, group_sums
from segcore.cut.fields import SegmentFields
from segcore.cut.node_shapes import Shapes, cuts_of, moment_sums, shapes_of
from segcore.graphs.cheeger import Cut
from segcore.graphs.surface_graph import SurfaceGraph
from segcore.graphs.tree import Tree

# Set by hand: as for bodies that repeat (cut/bodies.py), and as for the cuts of siblings (cut/siblings.py).
_AREA = 0.05  # largest difference of the logarithms of the areas of two parts
_SPREAD = 0.05  # largest difference of their standard deviations along the principal axes, in the largest one
_LENGTH = log(1.5)  # largest difference of the logarithms of the lengths of the cuts
_SIDES = log(1.5)  # the same of the areas of the sides of a cut whose larger side can be what is cut off


def equal_cuts(graph: SurfaceGraph, points: FloatArray, tree: Tree) -> IntArray:
    """(S,) a number for every split, the same for splits that cut off congruent parts along equally long cuts.

    What a split cuts off is its smaller part. If that is like no other, the split belongs to those that cut off what
    its larger part is, if that is at most 1.5 times as large: the second flange of a beam is cut off the web.

    Parts are compared by their areas and by their standard deviations along the principal axes, and the cuts by their
    lengths, with those of the largest part of a group.

    Parameters
    ----------
    points : (N, 3) positions of the nodes of the graph.
    """
    shapes = shapes_of(graph, points, tree)
    by_area = np.argsort(-shapes.log_area[2::2], kind="stable")
    larger, smaller = (Shapes(shapes.log_area[k::2][by_area], shapes.spread[k::2][by_area]) for k in (1, 2))
    length = cuts_of(graph, tree).log_length[by_area]

    def equal_to(parts: Shapes, of: int) -> BoolArray:
        """(S,) True for the splits that cut off what the split ``of`` does, if that is its part among ``parts``."""
        is_equal = smaller.like(parts.log_area[of], parts.spread[of], _AREA, _SPREAD)
        return is_equal & (np.abs(length - length[of]) <= _LENGTH)

    group = np.full(len(by_area), -1, dtype=np.int32)
    for first in range(len(by_area)):
        if group[first] < 0:
            group[equal_to(smaller, first) & (group < 0)] = first
    alone = np.bincount(group, minlength=len(group))[group] == 1
    for split in np.flatnonzero(alone & (larger.log_area - smaller.log_area <= _SIDES)).tolist():
        others = np.flatnonzero(equal_to(larger, split))
        others = others[others != split]
        if len(others) > 0:
            group[split] = group[others[0]]
    number = np.empty_like(group)
    number[by_area] = group
    return number


def means_of_groups(group: IntArray, value: FloatArray, weight: FloatArray) -> FloatArray:
    """(S,) the weighted mean of the values of the group of each split.

    Parameters
    ----------
    group : (S,) any numbers.
    weight : (S,) > 0.
    """
    of_split = np.unique(group, return_inverse=True)[1]
    means: FloatArray = (group_sums(of_split, weight * value) / group_sums(of_split, weight))[of_split]
    return means


class _Part(NamedTuple):
    """Bodies, or what earlier cuts have left of them."""

    pieces: int
    shape: Shapes  # of one part


class PartedBodies:
    """The groups of bodies that have been cut off, so that congruent ones are cut off rather than others."""

    def __init__(self) -> None:
        self._pieces = np.empty(0, dtype=np.int64)  # of every known part
        self._known = Shapes(np.empty(0), np.empty((0, 3)))

    def parts(self, inside: SegmentFields, cuts: Sequence[Cut], is_between: BoolArray) -> list[_Part | None]:
        """What each of C cuts of a segment cuts off: the smaller side, or None if a cut divides a piece.

        Parameters
        ----------
        inside : of the segment.
        is_between : (C,) whether the cuts divide no piece.
        """
        if not is_between.any():
            return [None] * len(cuts)
        pieces = int(inside.piece.max()) + 1
        sums = moment_sums(inside.piece, inside.volume, inside.points, pieces)
        member = np.zeros(pieces, dtype=np.int32)
        member[inside.piece] = np.arange(len(inside.piece))
        parts: list[_Part | None] = []
        for cut, between in zip(cuts, is_between, strict=True):
            side = (cut.side if cut.inside <= cut.outside else ~cut.side)[member]
            parts.append(_Part(int(side.sum()), Shapes.of(sums[side].sum(axis=0)[None])) if between else None)
        return parts

    def has(self, parts: Sequence[_Part | None]) -> BoolArray:
        """(C,) whether each of some parts is congruent to one that was cut off before."""
        return np.array([part is not None and self._has(part) for part in parts])

    def add(self, part: _Part | None) -> None:
        """Remember a part that is cut off."""
        if part is not None and not self._has(part):
            known = self._known
            self._pieces = np.append(self._pieces, part.pieces)
            self._known = Shapes(
                np.append(known.log_area, part.shape.log_area), np.concatenate([known.spread, part.shape.spread])
            )

    def _has(self, part: _Part) -> bool:
        is_known = self._known.like(part.shape.log_area[0], part.shape.spread[0], _AREA, _SPREAD)
        return bool(np.any(is_known & (self._pieces == part.pieces)))
