"""Rows of an appearance that corners with equal attributes share."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from segcore.arrays import BoolArray, IntArray, LongArray


@dataclass(frozen=True, slots=True, eq=False)
class CornerRows:
    """Rows of an appearance: one for each vertex, then one for each further combination of attributes of a vertex."""

    of_corner: IntArray  # (C,) the row of each corner
    extra_vertex: IntArray  # (A - V,) the vertex of each further row
    corner: LongArray  # (A,) a corner with the attributes of the row; -1 if no corner has the vertex


@dataclass(frozen=True, slots=True, eq=False)
class CornerTable:
    """Values that the corners of faces refer to."""

    values: NDArray[Any]  # (N, *)
    rows: LongArray | IntArray  # (F, 3) the row of each corner, -1 if it has none


def rows_of_corners(vertices: LongArray | IntArray, picks: list[LongArray], vertex_count: int) -> CornerRows:
    """Give corners with the same vertex and the same picks one row; row v is that of the first corner of vertex v.

    Parameters
    ----------
    vertices : (C,) the vertex of each corner.
    picks : (C,) each, the entry of each corner in another table, such as the texture coordinates.
    """
    corner = np.full(vertex_count, -1, dtype=np.int64)
    every = np.arange(len(vertices))
    corner[vertices[::-1]] = every[::-1]  # the first corner of each vertex, because the last assignment stays
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
    """(C,) True for each corner that has another pick than the corner ``other``."""
    differ = np.zeros(len(other), dtype=bool)
    for pick in picks:
        differ |= pick != pick[other]
    return differ
