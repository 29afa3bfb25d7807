"""Compiled sums over the sides of cuts, from which the features of the cuts are made."""

from typing import NamedTuple

import numpy as np

from segcore.arrays import BoolArray, FloatArray, IntArray
from segcore.cut.fields import SegmentFields
from segcore.graphs.cheeger import side_volumes
from segcore.jit.decorators import inner_kernel

_WHOLE = 1.0 - 1e-9  # share of a body that counts as all of it


class SideSums(NamedTuple):
    """Sums over the small side (column 0) and the other side (column 1) of N cuts."""

    area: FloatArray  # (N, 2)
    weight: FloatArray  # (N, 2) of the edges inside
    length: FloatArray  # (N, 2) of the edges inside
    degree: FloatArray  # (N, 2)
    thickness: FloatArray  # (N, 2) mean
    thickness_spread: FloatArray  # (N, 2) standard deviation
    confidence: FloatArray  # (N, 2) mean
    open_border: FloatArray  # (N, 2)
    whole: FloatArray  # (N, 2) area of whole bodies
    pieces: FloatArray  # (N, 2) number of pieces with a part in the side
    centre: FloatArray  # (N, 2, 3) centroid
    variance: FloatArray  # (N, 2, 3) of the points along the principal axes, ascending


class CutSums(NamedTuple):
    """Sums over the borders of N cuts, and over both sides."""

    border: FloatArray  # (N,) length
    weight: FloatArray  # (N,)
    contact: FloatArray  # (N,) length of the contacts between bodies in it
    flat: FloatArray  # (N,) length of what runs between coplanar faces
    concavity: FloatArray  # (N,) of the contacts, times their length
    thickness: FloatArray  # (N,) mean along the border
    divided: FloatArray  # (N,) area of the pieces with parts in both sides
    touched: FloatArray  # (N,) area of the bodies with a part in the small side
    only: IntArray  # (N,) the body that the small side is, -1 if it is not one whole body
    boxed: FloatArray  # (N,) area of the small side in the box around the other side, along its principal axes


@inner_kernel
def sums_of_cuts(part: SegmentFields, chosen: BoolArray, body_area: FloatArray) -> tuple[SideSums, CutSums]:
    """The sums of cuts of a segment.

    Parameters
    ----------
    chosen : (N, M) one side of every cut.
    body_area : (B,) the areas of all bodies.
    """
    count = len(chosen)
    sides = SideSums(
        np.zeros((count, 2)), np.zeros((count, 2)), np.zeros((count, 2)), np.zeros((count, 2)), np.zeros((count, 2)),
        np.zeros((count, 2)), np.zeros((count, 2)), np.zeros((count, 2)), np.zeros((count, 2)), np.zeros((count, 2)),
        np.zeros((count, 2, 3)), np.zeros((count, 2, 3)),
    )  # fmt: skip
    cuts = CutSums(
        np.zeros(count), np.zeros(count), np.zeros(count), np.zeros(count), np.zeros(count), np.zeros(count),
        np.zeros(count), np.zeros(count), np.full(count, -1, dtype=np.int32), np.zeros(count),
    )  # fmt: skip
    for n in range(count):
        small = _smaller(part, chosen[n])
        _add_edges(part, small, n, sides, cuts)
        _add_nodes(part, small, n, sides)
        axes = _principal_axes(part, small, n, sides)
        cuts.boxed[n] = _area_in_box(part, small, axes)
        _add_pieces(part, small, n, sides, cuts)
        _add_bodies(part, small, n, body_area, sides, cuts)
    return sides, cuts


@inner_kernel
def _smaller(part: SegmentFields, side: BoolArray) -> BoolArray:
    """(M,) the side of less area; the given one of two equals."""
    inside, outside = side_volumes(part.volume, side)
    return side if inside <= outside else ~side


@inner_kernel
def _add_edges(part: SegmentFields, small: BoolArray, n: int, sides: SideSums, cuts: CutSums) -> None:
    for e in range(len(part.edges)):
        a, b = part.edges[e, 0], part.edges[e, 1]
        length = part.length[e]
        if small[a] == small[b]:
            row = 0 if small[a] else 1
            sides.weight[n, row] += part.weight[e]
            sides.length[n, row] += length
        else:
            cuts.border[n] += length
            cuts.weight[n] += part.weight[e]
            cuts.flat[n] += length * part.flat[e]
            cuts.thickness[n] += length * 0.5 * (part.thickness[a] + part.thickness[b])
            if part.body[a] != part.body[b]:
                cuts.contact[n] += length
                cuts.concavity[n] += length * part.concavity[e]
    cuts.thickness[n] /= cuts.border[n]


@inner_kernel
def _add_nodes(part: SegmentFields, small: BoolArray, n: int, sides: SideSums) -> None:
    for i in range(len(small)):
        row = 0 if small[i] else 1
        v, t = part.volume[i], part.thickness[i]
        sides.area[n, row] += v
        sides.degree[n, row] += part.degree[i]
        sides.open_border[n, row] += part.open_border[i]
        sides.thickness[n, row] += v * t
        sides.thickness_spread[n, row] += v * t * t
        sides.confidence[n, row] += v * part.confidence[i]
        for k in range(3):
            sides.centre[n, row, k] += v * part.points[i, k]
    for row in range(2):
        area = sides.area[n, row]
        sides.thickness[n, row] /= area
        mean = sides.thickness[n, row]
        sides.thickness_spread[n, row] = np.sqrt(max(sides.thickness_spread[n, row] / area - mean * mean, 0.0))
        sides.confidence[n, row] /= area
        for k in range(3):
            sides.centre[n, row, k] /= area


@inner_kernel
def _principal_axes(part: SegmentFields, small: BoolArray, n: int, sides: SideSums) -> FloatArray:
    """Fill in the variances; return the principal axes of the other side as the rows of (3, 3)."""
    covariance = np.zeros((2, 3, 3))
    for i in range(len(small)):
        row = 0 if small[i] else 1
        share = part.volume[i] / sides.area[n, row]
        for k in range(3):
            away = share * (part.points[i, k] - sides.centre[n, row, k])
            for m in range(k + 1):
                covariance[row, k, m] += away * (part.points[i, m] - sides.centre[n, row, m])
    axes = np.empty((3, 3))
    for row in range(2):
        variance, vectors = np.linalg.eigh(covariance[row])
        for k in range(3):
            sides.variance[n, row, k] = max(variance[k], 0.0)
            for m in range(3):
                axes[k, m] = vectors[m, k]
    return axes


@inner_kernel
def _area_in_box(part: SegmentFields, small: BoolArray, axes: FloatArray) -> float:
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    along = np.empty((len(small), 3))
    for i in range(len(small)):
        x, y, z = part.points[i]
        for k in range(3):
            along[i, k] = axes[k, 0] * x + axes[k, 1] * y + axes[k, 2] * z
            if not small[i]:
                low[k] = min(low[k], along[i, k])
                high[k] = max(high[k], along[i, k])
    inside = 0.0
    for i in range(len(small)):
        if small[i]:
            is_inside = True
            for k in range(3):
                is_inside = is_inside and low[k] <= along[i, k] <= high[k]
            if is_inside:
                inside += part.volume[i]
    return inside


@inner_kernel
def _add_pieces(part: SegmentFields, small: BoolArray, n: int, sides: SideSums, cuts: CutSums) -> None:
    area = np.zeros((2, part.piece.max() + 1))
    for i in range(len(small)):
        area[0 if small[i] else 1, part.piece[i]] += part.volume[i]
    for p in range(area.shape[1]):
        for row in range(2):
            if area[row, p] > 0.0:
                sides.pieces[n, row] += 1.0
        if area[0, p] > 0.0 and area[1, p] > 0.0:
            cuts.divided[n] += area[0, p] + area[1, p]


@inner_kernel
def _add_bodies(
    part: SegmentFields, small: BoolArray, n: int, body_area: FloatArray, sides: SideSums, cuts: CutSums
) -> None:
    inside = np.zeros((2, len(body_area)))
    for i in range(len(small)):
        inside[0 if small[i] else 1, part.body[i]] += part.volume[i]
    bodies, only = 0, -1
    for b in range(len(body_area)):
        for row in range(2):
            if inside[row, b] >= _WHOLE * body_area[b]:
                sides.whole[n, row] += inside[row, b]
        if inside[0, b] > 0.0:
            cuts.touched[n] += body_area[b]
            bodies += 1
            only = b
    if bodies == 1 and inside[0, only] >= _WHOLE * body_area[only]:
        cuts.only[n] = only
