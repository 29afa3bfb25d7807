"""Stitching of a surface: patches that meet along their borders become one, across gaps and at corners on edges."""

from dataclasses import dataclass

import numpy as np

from segcore.arrays import BoolArray, FloatArray, IntArray
from segcore.clean.borders import ends_of, open_edges
from segcore.clean.matches import Matches, are_adjacent, find_matches
from segcore.clean.runs import reliable_matches
from segcore.clean.topology import DualEdges, dual_edges, first_equal_row
from segcore.graphs.surface_graph import connected_components

_WELD_REACH = 2.0  # in largest gaps: corners of two patches are apart along the border as well; set by hand
_WELD_SHARE = 0.4  # of the shorter edge, the largest distance of two vertices that become one; set by hand


@dataclass(frozen=True, slots=True, eq=False)
class Stitched:
    """A surface without the cracks and T-junctions that it had."""

    vertices: FloatArray  # (V, 3) those that became one are at their mean
    faces: IntArray  # (F, 3) in the order of before
    dual: DualEdges  # those of shared edges, then those of edges that run along each other
    edges: int  # number of open edges that have been joined
    gap: float  # the widest gap that has been bridged


def stitch(vertices: FloatArray, faces: IntArray, dual: DualEdges) -> Stitched:
    """Join the open edges of a surface that continue each other; no face is lost, and their order is kept.

    Vertices that meet at a match become one. Two edges that are not the same after that get a dual edge whose ends are
    those of the interval that they share. A surface without matches is returned as it is.

    Parameters
    ----------
    vertices : (V, 3) in a box of extent 1.
    faces : (F, 3) with three different corners each.
    dual : their dual edges.
    """
    borders = open_edges(faces, dual)
    if len(borders) < 2:
        return Stitched(vertices, faces, dual, 0, 0.0)
    ends = ends_of(borders, faces)
    length = np.linalg.norm(vertices[ends[:, 1]] - vertices[ends[:, 0]], axis=1)
    matches = reliable_matches(find_matches(vertices, faces, dual, borders), faces, dual, borders, length)
    if len(matches.gap) == 0:
        return Stitched(vertices, faces, dual, 0, 0.0)
    group = _welded(matches, ends, length, vertices, faces)
    if len(group) and int(group.max()) + 1 < len(group):
        vertices, faces = _means(vertices, group), group[faces]
        dual = dual_edges(faces, len(vertices))
    dual = _with_matches(dual, matches, faces, borders, group)
    joined = len(np.unique(matches.edges))
    return Stitched(vertices, faces, dual, joined, float(matches.gap.max()))


def _welded(matches: Matches, ends: IntArray, length: FloatArray, vertices: FloatArray, faces: IntArray) -> IntArray:
    """(V,) the vertex 0, 1, ... that replaces every vertex: those that meet at a match become one, in the same order.

    Parameters
    ----------
    ends, length : (B, 2) and (B,) of the open edges.
    """
    one, other = ends[matches.edges[:, 0]], ends[matches.edges[:, 1]]
    other = np.where(matches.disagrees[:, None], other, other[:, ::-1])
    pairs = np.concatenate([np.stack([one[:, k], other[:, k]], axis=1) for k in (0, 1)])
    distance = np.linalg.norm(vertices[pairs[:, 0]] - vertices[pairs[:, 1]], axis=1)
    shorter = np.tile(length[matches.edges].min(axis=1), 2)
    near = distance <= np.minimum(_WELD_REACH * matches.gap.max(), _WELD_SHARE * shorter)
    joined, which = np.unique(pairs[near], return_inverse=True)
    component = connected_components(which.reshape(-1, 2).astype(np.int32), len(joined))
    _, first = np.unique(component, return_index=True)
    group = np.arange(len(vertices), dtype=np.int32)
    group[joined] = joined[first[component]]
    group[_of_spoilt_faces(group, faces)[group]] = -1
    group = np.where(group < 0, np.arange(len(vertices)), group)
    remains = group == np.arange(len(vertices))
    renumbered: IntArray = (np.cumsum(remains, dtype=np.int32) - 1)[group]
    return renumbered


def _of_spoilt_faces(group: IntArray, faces: IntArray) -> BoolArray:
    """(V,) True for the vertices of faces that lose a corner, or become the same face as another one."""
    touched = faces[(group[faces] != faces).any(axis=1)]
    changed = np.zeros(len(group), dtype=bool)
    changed[group[touched]] = True
    moved = group[faces[changed[group[faces]].all(axis=1)]]
    a, b, c = moved.T
    spoilt = (a == b) | (b == c) | (c == a)
    twin = first_equal_row(np.sort(moved, axis=1).astype(np.int64))
    repeated = twin != np.arange(len(moved))
    spoilt[repeated], spoilt[twin[repeated]] = True, True
    of_spoilt = np.zeros(len(group), dtype=bool)
    of_spoilt[moved[spoilt]] = True
    return of_spoilt


def _with_matches(dual: DualEdges, matches: Matches, faces: IntArray, borders: IntArray, group: IntArray) -> DualEdges:
    """The dual edges, and one for every pair of faces that match and have none, along the longest of their matches."""
    order = np.argsort(-matches.length, kind="stable")
    sides, ends = np.sort(borders[matches.edges[order], 0], axis=1), np.sort(group[matches.ends[order]], axis=1)
    is_new = (ends[:, 0] != ends[:, 1]) & ~are_adjacent(sides, dual.faces, len(faces))
    _, first = np.unique(sides[is_new], axis=0, return_index=True)
    added = np.flatnonzero(is_new)[first]
    return DualEdges(
        np.concatenate([dual.faces, sides[added]]),
        np.concatenate([dual.vertices, ends[added]]),
        np.concatenate([dual.is_manifold, np.ones(len(added), dtype=bool)]),
        np.concatenate([dual.disagrees, matches.disagrees[order][added]]),
    )


def _means(vertices: FloatArray, group: IntArray) -> FloatArray:
    """(max(group) + 1, 3) the mean of the vertices of every group; a single vertex keeps its coordinates."""
    size = np.bincount(group)
    sums = np.stack([np.bincount(group, coordinate) for coordinate in vertices.T], axis=1)
    means: FloatArray = sums / size[:, None]
    return means
