"""Corners that look alike share a row of the appearance."""

from dataclasses import dataclass

import numpy as np

from segcore.arrays import IntArray, LongArray


@dataclass(frozen=True, slots=True, eq=False)
class CornerRows:
    """Rows of an appearance: one for each vertex, then one for each other look that a vertex has."""

    of_corner: IntArray  # (C,) the row of every corner
    extra_vertex: IntArray  # (A - V,) the vertex of every further row
    corner: LongArray  # (A,) a corner that looks like the row; -1 where no corner has the vertex


def rows_of_corners(vertices: LongArray | IntArray, picks: list[LongArray], vertex_count: int) -> CornerRows:
    """Give corners of the same vertex and the same picks the same row.

    Parameters
    ----------
    vertices : (C,) the vertex of every corner.
    picks : (C,) each: what else every corner picks, such as a texture coordinate.
    """
    order = np.lexsort([*picks, vertices])
    keys = [key[order] for key in (vertices, *picks)]
    changes = np.any([key[1:] != key[:-1] for key in keys], axis=0)
    look_of_sorted = np.concatenate([[0], np.cumsum(changes)]) if len(order) else np.zeros(0, dtype=np.int64)
    first = order[np.concatenate([[True], changes])] if len(order) else order
    vertex_of_look = vertices[first]
    is_extra = (
        np.concatenate([[False], vertex_of_look[1:] == vertex_of_look[:-1]]) if len(first) else first.astype(bool)
    )
    row_of_look = np.where(is_extra, vertex_count + np.cumsum(is_extra) - 1, vertex_of_look)
    of_corner = np.empty(len(vertices), dtype=np.int32)
    of_corner[order] = row_of_look[look_of_sorted]
    corner = np.full(vertex_count + int(is_extra.sum()), -1, dtype=np.int64)
    corner[row_of_look] = first
    return CornerRows(of_corner, vertex_of_look[is_extra].astype(np.int32), corner)
