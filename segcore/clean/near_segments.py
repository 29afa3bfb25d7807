"""Finds the points that lie beside segments, with both in the order of the cells of a grid."""

from typing import NamedTuple

import numpy as np

from segcore.arrays import BoolArray, FloatArray, IntArray, LongArray
from segcore.jit.decorators import inner_kernel, kernel

_SMALLEST_CELL = 1e-6  # of the extent, so that the number of a cell of the whole grid fits 64 bits
_MOST_SEGMENTS = 32  # beside one point; set by hand, at cracks and T-junctions there are less than ten
# Samples of all segments. A mesh of 1,000,000 faces that is all border has about as many; only long thin faces by the
# hundred thousand, which are no patches with cracks, have more.
_MOST_SAMPLES = 2**21
_BEYOND = 0.01  # share of a segment by which a foot may lie beyond its ends: rounding, and edges of unequal length


def near_segments(points: FloatArray, ends: IntArray, radius: FloatArray) -> LongArray:
    """(M, 2) the pairs of a segment and a point beside it within its radius that is none of its ends.

    A point with more than 32 segments, its own included, is in a thicket and not at a crack: it is left out. A point is
    beside a segment if its perpendicular foot lies between the ends, to a hundredth of the length.

    The segments are handled in classes of similar radius, each with a grid of its own, so that the cost does not depend
    on how different they are.

    Parameters
    ----------
    points : (N, 3) in a box of extent 1.
    ends : (S, 2) the points at which every segment begins and ends.
    radius : (S,)
    """
    level = np.ceil(np.log2(np.maximum(radius, _SMALLEST_CELL))).astype(np.int64)
    is_searched = _within_budget(np.linalg.norm(points[ends[:, 1]] - points[ends[:, 0]], axis=1) / 2.0**level)
    found = [np.zeros((0, 2), dtype=np.int64)]
    for one in np.unique(level):
        chosen = np.flatnonzero((level == one) & is_searched)
        cell = 1.25 * 2.0**one  # every point beside a segment is then less than a cell from a sample of the segment
        pairs = _in_grid(points, ends[chosen], radius[chosen], cell)
        found.append(np.stack([chosen[pairs[:, 0]], pairs[:, 1]], axis=1))
    return np.concatenate(found)


def _within_budget(samples: FloatArray) -> BoolArray:
    """(S,) True for the segments that are searched: all, or those with the fewest samples, if there are too many."""
    order = np.argsort(samples, kind="stable")
    chosen = np.empty(len(samples), dtype=bool)
    chosen[order] = np.cumsum(samples[order]) <= _MOST_SAMPLES
    return chosen


class _Grid(NamedTuple):
    """Cells of a grid in a box, with empty cells on all sides."""

    low: FloatArray  # (3,) the corner of the box
    cell: float  # the side of a cell
    shape: LongArray  # (3,) the number of cells


def _in_grid(points: FloatArray, ends: IntArray, radius: FloatArray, cell: float) -> LongArray:
    """(M, 2) the pairs of a segment and a point beside it, by the segment, its samples, the cells and the point.

    Points are numbered in the order of their cells, and segments in the order of their first ends: what is near in
    space is then near in memory as well.
    """
    low = points.min(axis=0)
    grid = _Grid(low, cell, ((points.max(axis=0) - low) / cell).astype(np.int64) + 3)
    cells = _cells(points, grid)
    of_place = np.argsort(cells)
    place = np.empty(len(points), dtype=np.int32)
    place[of_place] = np.arange(len(points), dtype=np.int32)
    ends = place[ends]
    order = np.argsort(ends[:, 0], kind="stable")
    cells = cells[of_place]
    segment, sample, place = _beside(points[of_place], cells, ends[order], radius[order], grid).T
    segment, point = order[segment], of_place[place]
    return np.stack([segment, point], axis=1)[np.lexsort((point, cells[place], sample, segment))]


@kernel
def _cells(points: FloatArray, grid: _Grid) -> LongArray:
    """(N,) the number of the cell of every point."""
    cells = np.zeros(len(points), np.int64)
    for i in range(len(points)):
        for axis in range(3):
            at = int((points[i, axis] - grid.low[axis]) / grid.cell) + 1
            cells[i] = cells[i] * grid.shape[axis] + at
    return cells


@inner_kernel
def _squared(step: FloatArray) -> float:
    return step[0] * step[0] + step[1] * step[1] + step[2] * step[2]


@kernel
def _beside(points: FloatArray, cells: LongArray, ends: IntArray, radius: FloatArray, grid: _Grid) -> LongArray:
    """(M, 3) a segment, the number of its sample that is nearest to the foot of a point, and this point.

    The samples of a segment are at distances of at most a cell. Around the cell of each are nine rows of three cells;
    the places of the rows are searched from those of the sample before.

    Parameters
    ----------
    cells : (N,) of the points, ascending.
    """
    found = np.empty((16, 3), np.int64)
    count = 0
    rows = np.zeros(9, np.int64)
    segments_at = _segments_that_end(points, ends)
    for s in range(len(ends)):
        first, last = ends[s]
        begin = points[first]
        step = points[last] - begin
        samples = int(np.sqrt(_squared(step)) / grid.cell) + 1
        for sample in range(samples):
            cell = _cell_of(begin, step, (sample + 0.5) / samples, grid)
            for row in range(9):
                middle = cell + ((row // 3 - 1) * grid.shape[1] + row % 3 - 1) * grid.shape[2]
                p = rows[row] = _first_from(cells, middle - 1, rows[row])
                while p < len(points) and cells[p] <= middle + 1:
                    if segments_at[p] <= _MOST_SEGMENTS and p != first and p != last:
                        at, distance = _foot(points[p], begin, step)
                        is_nearest = min(max(int(at * samples), 0), samples - 1) == sample
                        if is_nearest and distance <= radius[s] * radius[s]:
                            segments_at[p] += 1
                            if count == len(found):
                                larger = np.empty((2 * count, 3), np.int64)
                                larger[:count] = found
                                found = larger
                            found[count, 0], found[count, 1], found[count, 2] = s, sample, p
                            count += 1
                    p += 1
    is_sparse = segments_at[found[:count, 2]] <= _MOST_SEGMENTS
    return found[:count][is_sparse]


@inner_kernel
def _segments_that_end(points: FloatArray, ends: IntArray) -> IntArray:
    """(N,) the number of segments with a length that end at every point."""
    count = np.zeros(len(points), np.int32)
    for s in range(len(ends)):
        if _squared(points[ends[s, 1]] - points[ends[s, 0]]) > 0.0:
            count[ends[s, 0]] += 1
            count[ends[s, 1]] += 1
    return count


@inner_kernel
def _cell_of(begin: FloatArray, step: FloatArray, share: float, grid: _Grid) -> int:
    """The cell of the place at a share of a segment."""
    cell = 0
    for axis in range(3):
        cell = cell * grid.shape[axis] + int((begin[axis] + share * step[axis] - grid.low[axis]) / grid.cell) + 1
    return cell


@inner_kernel
def _first_from(cells: LongArray, least: int, p: int) -> int:
    """The first place at which ascending cells are at least ``least``, in steps that double from the place p."""
    low, high, step = p, p, 1
    while high < len(cells) and cells[high] < least:
        low, high, step = high + 1, high + step, 2 * step
    high = min(high, len(cells))
    while low > 0 and cells[low - 1] >= least:
        low, high, step = max(low - step, 0), low - 1, 2 * step
    while low < high:
        middle = (low + high) // 2
        if cells[middle] < least:
            low = middle + 1
        else:
            high = middle
    return low


@inner_kernel
def _foot(point, begin, step):  # type: ignore[no-untyped-def]
    """The foot of a point as a share of a segment, and its squared distance, infinity if it is beyond the ends."""
    squared = _squared(step)
    at = 0.0
    for axis in range(3):
        at += (point[axis] - begin[axis]) * step[axis]
    at = at / squared if squared > 0.0 else -1.0
    if not -_BEYOND <= at <= 1.0 + _BEYOND:
        return 0.0, np.inf
    distance = 0.0
    for axis in range(3):
        distance += (point[axis] - begin[axis] - at * step[axis]) ** 2
    return at, distance
