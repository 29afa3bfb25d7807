"""Compiled decoders of meshoptimizer's codecs for indices: of triangles, and in any order.

References
----------
The glTF extensions EXT_meshopt_compression and KHR_meshopt_compression, appendix A (bitstreams).
"""

from typing import NamedTuple

import numpy as np

from segcore.arrays import LongArray
from segcore.io.gltf.compression.meshopt_attributes import Bytes
from segcore.jit.decorators import inlined_kernel, inner_kernel, kernel

_TRIANGLES, _INDICES = 0xE1, 0xD1  # the first byte of the data
_TRIANGLE_TAIL, _INDEX_TAIL = 16, 4  # bytes at the end: a table of codes, and padding
_NEWEST = 15  # entry i of a queue of 16 is at position i & 15


class Cursor(NamedTuple):
    """The state of the decoder of triangles."""

    at: int  # the next byte
    following: int  # the next vertex that no triangle has used
    last: int  # the last vertex that was coded as a difference


@kernel
def decode_triangles(source: Bytes, target: LongArray) -> bool:
    """Fill ``target`` (3 T,) with vertices of triangles; return False if the data is damaged."""
    triangles = len(target) // 3
    end = len(source) - _TRIANGLE_TAIL
    cursor = Cursor(1 + triangles, 0, 0)
    if cursor.at > end or source[0] != _TRIANGLES:
        return False
    edges, vertices = np.zeros((16, 2), np.int64), np.zeros(16, np.int64)  # queues
    edge, vertex = 0, 0  # the number of entries that were appended to each
    for t in range(triangles):
        if cursor.at > end:
            return False
        high, low = source[1 + t] >> 4, source[1 + t] & 15
        if high < 15:  # an edge of an earlier triangle
            a, b = edges[(edge - 1 - high) & _NEWEST, 0], edges[(edge - 1 - high) & _NEWEST, 1]
            c, cursor = _third_corner(source, cursor, low, vertices[(vertex - 1 - low) & _NEWEST])
            if low == 0 or low > 12:
                vertices[vertex & _NEWEST] = c
                vertex += 1
        else:
            is_listed = low < 14  # in the table of codes at the end
            pair = source[end + low] if is_listed else source[cursor.at]
            if not is_listed:
                cursor = Cursor(cursor.at + 1, 0 if pair == 0 else cursor.following, cursor.last)
            a, cursor = _new_corner(cursor) if low < 15 else _coded_corner(source, cursor)
            high, low = pair >> 4, pair & 15
            b, cursor = _corner(source, cursor, high, is_listed, vertices[(vertex - high) & _NEWEST])
            c, cursor = _corner(source, cursor, low, is_listed, vertices[(vertex - low) & _NEWEST])
            vertices[vertex & _NEWEST] = a
            vertex += 1
            if high == 0 or (high == 15 and not is_listed):
                vertices[vertex & _NEWEST] = b
                vertex += 1
            if low == 0 or (low == 15 and not is_listed):
                vertices[vertex & _NEWEST] = c
                vertex += 1
            edges[edge & _NEWEST, 0], edges[edge & _NEWEST, 1] = b, a
            edge += 1
        edges[edge & _NEWEST, 0], edges[edge & _NEWEST, 1] = c, b
        edges[(edge + 1) & _NEWEST, 0], edges[(edge + 1) & _NEWEST, 1] = a, c
        edge += 2
        target[3 * t], target[3 * t + 1], target[3 * t + 2] = a, b, c
    return cursor.at == end


@inlined_kernel
def _third_corner(source: Bytes, cursor: Cursor, code: int, known: int) -> tuple[int, Cursor]:
    """The corner opposite to an edge of an earlier triangle; ``known`` is the one for the codes 1 to 12."""
    if code == 0:
        return _new_corner(cursor)
    if code < 13:
        return known, cursor
    if code < 15:
        last = cursor.last + (1 if code == 14 else -1)
        return last, Cursor(cursor.at, cursor.following, last)
    return _coded_corner(source, cursor)


@inner_kernel
def _corner(source: Bytes, cursor: Cursor, code: int, is_listed: bool, known: int) -> tuple[int, Cursor]:
    """The second or third corner of a triangle without an earlier edge; ``known`` is the one for the codes 1 to 14."""
    if code == 0:
        return _new_corner(cursor)
    if code == 15 and not is_listed:
        return _coded_corner(source, cursor)
    return known, cursor


@inlined_kernel
def _new_corner(cursor: Cursor) -> tuple[int, Cursor]:
    return cursor.following, Cursor(cursor.at, cursor.following + 1, cursor.last)


@inner_kernel
def _coded_corner(source: Bytes, cursor: Cursor) -> tuple[int, Cursor]:
    """A corner that is coded as the difference to the last one that was."""
    at, value = _number(source, cursor.at, len(source))
    last = cursor.last + ((value >> 1) ^ -(value & 1))
    return last, Cursor(at, cursor.following, last)


@kernel
def decode_indices(source: Bytes, target: LongArray) -> bool:
    """Fill ``target`` (N,) with indices in any order; return False if the data is damaged."""
    at, end = 1, len(source) - _INDEX_TAIL
    if end < 1 or source[0] != _INDICES:
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


@inner_kernel
def _number(source: Bytes, at: int, end: int) -> tuple[int, int]:
    """The end of a number of at most five bytes with seven bits each, and the number."""
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
