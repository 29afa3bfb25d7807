"""Corners that look alike share a row of the appearance."""

from dataclasses import dataclass

import numpy as np

from segcore.arrays import BoolArray, IntArray, LongArray


@dataclass(frozen=True, slots=True, eq=False)
class CornerRows:
    """Rows of an appearance: one for each vertex, then one for each other look that a vertex has."""

    of_corner: IntArray  # (C,) the row of every corner
    extra_vertex: IntArray  # (A - V,) the vertex of every further row
    corner: LongArray  # (A,) a corner that looks like the row; -1 where no corner has the vertex


def rows_of_corners(vertices: LongArray | IntArray, picks: list[LongArray], vertex_count: int) -> CornerRows:
    """Give corners of the same vertex and the same picks the same row; the first corner of a vertex gets its own.

    Parameters
    ----------
    vertices : (C,) the vertex of every corner.
    picks : (C,) each: what else every corner picks, such as a texture coordinate.
    """
    corner = np.full(vertex_count, -1, dtype=np.int64)
    every = np.arange(len(vertices))
    corner[vertices[::-1]] = every[::-1]  # the first corner of every vertex, as the last value stays
    of_corner = vertices.astype(np.int32)
    others = np.flatnonzero(_differ(picks, corner[vertices]))
    order = others[np.lexsort([*(pick[others] for pick in picks), vertices[others]])]
    keys = [key[order] for key in (vertices, *picks)]
    is_new = np.ones(len(order), dtype=bool)
    is_new[1:] = np.any([key[1:] != key[:-1] for key in keys], axis=0)
    of_corner[order] = vertex_count + np.cumsum(is_new) - 1
    first = order[is_new]
    return CornerRows(of_corner, vertices[first].astype(np.int32), np.concatenate([corner, first]))


def _differ(picks: list[LongArray], other: LongArray) -> BoolArray:
    """(C,): the corners of which a pick is not that of the corner ``other``."""
    differ = np.zeros(len(other), dtype=bool)
    for pick in picks:
        differ |= pick != pick[other]
    return differ
