"""Compiled decoders of meshoptimizer's codecs for the indices of triangles, and for any indices. Arrays in, arrays out.

References
----------
The glTF extensions EXT_meshopt_compression and KHR_meshopt_compression, appendix A (bitstreams).
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from segcore.arrays import LongArray

Bytes = NDArray[np.uint8]


@njit(cache=True)
def decode_triangles(source: Bytes, target: LongArray) -> bool:
    """Fill ``target`` (3 T,) with vertex indices; False where the data is damaged."""
    triangles = len(target) // 3
    codes, at, end = 1, 1 + triangles, len(source) - 16
    if at > end or source[0] != 0xE1:
        return False
    edges, vertices = np.zeros((16, 2), np.int64), np.zeros(16, np.int64)
    edge, vertex, following, last = 0, 0, 0, 0
    for t in range(triangles):
        if at > end:
            return False
        code = source[codes + t]
        high, low = code >> 4, code & 15
        if high < 15:
            a, b = edges[(edge - 1 - high) & 15, 0], edges[(edge - 1 - high) & 15, 1]
            if low == 0:
                c = following
                following += 1
            elif low < 13:
                c = vertices[(vertex - 1 - low) & 15]
            elif low < 15:
                c = last = last + (1 if low == 14 else -1)
            else:
                at, last = _moved(source, at, last)
                c = last
            if low == 0 or low > 12:
                vertices[vertex & 15] = c
                vertex += 1
        else:
            if low < 14:
                pair = source[end + low]
                first_is_new = True
            else:
                pair = source[at]
                at += 1
                first_is_new = low == 14
                if pair == 0:
                    following = 0
            high, low = pair >> 4, pair & 15
            explicit = code & 15 >= 14
            if first_is_new:
                a = following
                following += 1
            else:
                at, last = _moved(source, at, last)
                a = last
            b, at, following, last = _listed(
                source, at, high, explicit, vertices[(vertex - high) & 15], following, last
            )
            c, at, following, last = _listed(source, at, low, explicit, vertices[(vertex - low) & 15], following, last)
            vertices[vertex & 15] = a
            vertex += 1
            if high == 0 or (high == 15 and explicit):
                vertices[vertex & 15] = b
                vertex += 1
            if low == 0 or (low == 15 and explicit):
                vertices[vertex & 15] = c
                vertex += 1
            edges[edge & 15, 0], edges[edge & 15, 1] = b, a
            edge += 1
        edges[edge & 15, 0], edges[edge & 15, 1] = c, b
        edges[(edge + 1) & 15, 0], edges[(edge + 1) & 15, 1] = a, c
        edge += 2
        target[3 * t], target[3 * t + 1], target[3 * t + 2] = a, b, c
    return at == end


@njit(cache=True)
def _listed(
    source: Bytes, at: int, place: int, explicit: bool, known: int, following: int, last: int
) -> tuple[int, int, int, int]:
    """A corner that is new (place 0), written out (15) or ``known``; ``at``, ``following`` and ``last`` moved on."""
    if place == 0:
        return following, at, following + 1, last
    if place == 15 and explicit:
        at, last = _moved(source, at, last)
        return last, at, following, last
    return known, at, following, last


@njit(cache=True)
def decode_indices(source: Bytes, target: LongArray) -> bool:
    """Fill ``target`` (N,) with indices in any order; False where the data is damaged."""
    at, end = 1, len(source) - 4
    if end < 1 or source[0] != 0xD1:
        return False
    last = np.zeros(2, np.int64)
    for i in range(len(target)):
        if at >= end:
            return False
        at, value = _number(source, at, end)
        which = value & 1
        last[which] += (value >> 2) ^ -((value >> 1) & 1)
        target[i] = last[which]
    return at == end


@njit(cache=True)
def _moved(source: Bytes, at: int, last: int) -> tuple[int, int]:
    """Where the next number ends, and ``last`` moved by it."""
    at, value = _number(source, at, len(source))
    return at, last + ((value >> 1) ^ -(value & 1))


@njit(cache=True)
def _number(source: Bytes, at: int, end: int) -> tuple[int, int]:
    """Where a number of at most five bytes, seven bits each, ends, and the number."""
    value = 0
    for shift in range(0, 35, 7):
        if at >= end:
            break
        byte = source[at]
        at += 1
        value |= int(byte & 127) << shift
        if byte < 128:
            break
    return at, value
