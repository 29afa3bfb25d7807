"""Compiled kernels that find the open edges of a surface and the places that lie near them."""

import numpy as np
from numba import njit

from segcore.arrays import BoolArray, FloatArray, IntArray, LongArray
from segcore.clean.topology import DualEdges

_SMALLEST_CELL = 1e-6  # of the extent, so that the number of a cell of the whole grid fits 64 bits
_MOST_SEGMENTS = 32  # beside one point; set by hand, at cracks and T-junctions there are less than ten
# Samples of all segments. A mesh of 1,000,000 faces that is all border has about as many; only long thin faces by the
# hundred thousand, which are no patches with cracks, have more.
_MOST_SAMPLES = 2**21
_BEYOND = 0.01  # share of a segment by which a foot may lie beyond its ends: rounding, and edges of unequal length


def open_edges(faces: IntArray, dual: DualEdges) -> IntArray:
    """(B, 2) the face and the corner at which every edge of exactly one face begins, in ascending order.

    Parameters
    ----------
    dual : the dual edges of the faces.
    """
    if len(dual.faces) * 2 == 3 * len(faces) and bool(dual.is_manifold.all()):
        return np.empty((0, 2), dtype=np.int32)
    paired = _paired(faces, dual.faces, dual.vertices)
    return np.argwhere(~paired).astype(np.int32)


def ends_of(borders: IntArray, faces: IntArray) -> IntArray:
    """(B, 2) the two vertices of open edges (B, 2), in the order of the face."""
    face, corner = borders.T
    return np.stack([faces[face, corner], faces[face, (corner + 1) % 3]], axis=1)


@njit(cache=True)
def _paired(faces: IntArray, pairs: IntArray, ends: IntArray) -> BoolArray:
    """(F, 3) True for the edges, each beginning at a corner, that another face has as well."""
    paired = np.zeros((len(faces), 3), np.bool_)
    for e in range(len(pairs)):
        for side in range(2):
            f = pairs[e, side]
            for k in range(3):
                a, b = faces[f, k], faces[f, (k + 1) % 3]
                if min(a, b) == ends[e, 0] and max(a, b) == ends[e, 1]:
                    paired[f, k] = True
    return paired


def near_segments(points: FloatArray, segments: FloatArray, radius: FloatArray) -> LongArray:
    """(M, 2) the pairs of a segment and a point beside it within its radius.

    A point with more than 32 segments is in a thicket and not at a crack: it is left out. A point is beside a segment
    if its perpendicular foot lies between the ends, to a hundredth of the length.

    The segments are handled in classes of similar radius, each with a grid of its own, so that the cost does not depend
    on how different they are.

    Parameters
    ----------
    points : (N, 3) in a box of extent 1.
    segments : (S, 2, 3) begin and end.
    radius : (S,)
    """
    level = np.ceil(np.log2(np.maximum(radius, _SMALLEST_CELL))).astype(np.int64)
    is_searched = _within_budget(np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1) / 2.0**level)
    low = points.min(axis=0)
    found = [np.zeros((0, 2), dtype=np.int64)]
    for one in np.unique(level):
        chosen = np.flatnonzero((level == one) & is_searched)
        cell = 1.25 * 2.0**one  # every point beside a segment is then less than a cell from a sample of the segment
        index = ((points - low) / cell).astype(np.int64) + 1
        shape = index.max(axis=0) + 2
        key = (index[:, 0] * shape[1] + index[:, 1]) * shape[2] + index[:, 2]
        order = np.argsort(key, kind="stable")
        pairs = _in_grid(points, segments[chosen], radius[chosen], order, key[order], low, cell, shape)
        found.append(np.stack([chosen[pairs[:, 0]], pairs[:, 1]], axis=1))
    return np.concatenate(found)


def _within_budget(samples: FloatArray) -> BoolArray:
    """(S,) True for the segments that are searched: all, or those with the fewest samples, if there are too many."""
    order = np.argsort(samples, kind="stable")
    chosen = np.empty(len(samples), dtype=bool)
    chosen[order] = np.cumsum(samples[order]) <= _MOST_SAMPLES
    return chosen


@njit(cache=True)
def _in_grid(
    points: FloatArray,
    segments: FloatArray,
    radius: FloatArray,
    order: LongArray,
    keys: LongArray,
    low: FloatArray,
    cell: float,
    shape: LongArray,
) -> LongArray:
    """(M, 2) the pairs of a segment and a point, found by samples of the segments at distances of at most a cell."""
    found = np.empty((16, 2), np.int64)
    count = 0
    segments_at = np.zeros(len(points), np.int32)
    for s in range(len(segments)):
        begin = segments[s, 0]
        step = segments[s, 1] - begin
        squared = step[0] * step[0] + step[1] * step[1] + step[2] * step[2]
        samples = int(np.sqrt(squared) / cell) + 1
        for sample in range(samples):
            middle = (sample + 0.5) / samples
            x = int((begin[0] + middle * step[0] - low[0]) / cell) + 1
            y = int((begin[1] + middle * step[1] - low[1]) / cell) + 1
            z = int((begin[2] + middle * step[2] - low[2]) / cell) + 1
            for i in range(max(x - 1, 0), min(x + 2, shape[0])):
                for j in range(max(y - 1, 0), min(y + 2, shape[1])):
                    row = (i * shape[1] + j) * shape[2]
                    p = np.searchsorted(keys, row + max(z - 1, 0))
                    while p < len(keys) and keys[p] <= row + min(z + 1, shape[2] - 1):
                        v = order[p]
                        p += 1
                        if segments_at[v] > _MOST_SEGMENTS:
                            continue
                        at = 0.0
                        for axis in range(3):
                            at += (points[v, axis] - begin[axis]) * step[axis]
                        at = at / squared if squared > 0.0 else -1.0
                        if not -_BEYOND <= at <= 1.0 + _BEYOND:
                            continue
                        if min(max(int(at * samples), 0), samples - 1) != sample:
                            continue
                        distance = 0.0
                        for axis in range(3):
                            distance += (points[v, axis] - begin[axis] - at * step[axis]) ** 2
                        if distance <= radius[s] * radius[s]:
                            segments_at[v] += 1
                            if count == len(found):
                                larger = np.empty((2 * count, 2), np.int64)
                                larger[:count] = found
                                found = larger
                            found[count, 0], found[count, 1] = s, v
                            count += 1
    is_sparse = segments_at[found[:count, 1]] <= _MOST_SEGMENTS
    return found[:count][is_sparse]
