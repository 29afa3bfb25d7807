"""Compiled decoder of meshoptimizer's codec for the attributes of vertices.

References
----------
The glTF extensions EXT_meshopt_compression and KHR_meshopt_compression, appendix A (bitstreams).
"""

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from segcore.jit.decorators import inner_kernel, kernel

Bytes: TypeAlias = NDArray[np.uint8]

# All numbers are those of the bitstream.
_HEADER = 10  # the upper half of the first byte; the lower half is the version
_GROUP = 16  # elements that are packed together
_BLOCK_BYTES, _BLOCK_ELEMENTS = 8192, 256  # the largest block
_SHORTEST_TAILS = (32, 24)  # bytes, of version 0 and 1


@kernel
def decode_attributes(source: Bytes, target: Bytes) -> bool:
    """Fill ``target`` (count, stride) with the rows of ``source``; return False if the data is damaged."""
    count, stride = target.shape
    version = source[0] & 15 if len(source) else 2
    if version > 1 or source[0] >> 4 != _HEADER:
        return False
    tail = stride + version * (stride // 4)
    end = len(source) - max(tail, _SHORTEST_TAILS[version])
    if end < 1:
        return False
    last = source[len(source) - tail : len(source) - tail + stride].copy()
    channels = np.zeros(stride // 4, np.uint8)
    if version == 1:
        channels[:] = source[len(source) - stride // 4 :]
    largest_block = min((_BLOCK_BYTES // stride) // _GROUP * _GROUP, _BLOCK_ELEMENTS)
    deltas = np.empty((stride, largest_block), np.uint8)
    at = 1
    for first in range(0, count, largest_block):
        rows = target[first : first + largest_block]
        at = _unpack_block(source, at, end, version, deltas, len(rows))
        if at < 0 or not _add_deltas(deltas, last, channels, rows):
            return False
    return at == end


@inner_kernel
def _unpack_block(source: Bytes, at: int, end: int, version: int, deltas: Bytes, size: int) -> int:
    """Fill ``deltas`` (stride, size or more); return the end of the data of the block, or -1."""
    stride = len(deltas)
    groups = (size + _GROUP - 1) // _GROUP
    controls = at
    at += version * (stride // 4)
    for byte in range(stride):
        if at > end:
            return -1
        control = (source[controls + byte // 4] >> (2 * (byte % 4))) & 3 if version else 0
        if control == 2:
            deltas[byte] = 0
            continue
        if control == 3:
            if at + size > end:
                return -1
            deltas[byte, :size] = source[at : at + size]
            at += size
            continue
        header = at
        at += (groups + 3) // 4
        for group in range(groups):
            if at > end:
                return -1
            mode = (source[header + group // 4] >> (2 * (group % 4))) & 3
            at = _unpack_group(source, at, _bits(version, control, mode), deltas[byte], _GROUP * group)
    return at if at <= end else -1


@inner_kernel
def _bits(version: int, control: int, mode: int) -> int:
    """The number of bits of each number of a group: 0, 1, 2, 4 or 8."""
    if version == 1 and control == 1:
        return 1 << mode
    if version == 1:
        return (1 << mode) >> 1
    return 0 if mode == 0 else 1 << mode


@inner_kernel
def _unpack_group(source: Bytes, at: int, bits: int, deltas: Bytes, first: int) -> int:
    """Fill 16 deltas from ``first`` on; return the end of the data of the group.

    A number with all bits set stands for one of the bytes that follow the numbers.
    """
    if bits == 8:
        for i in range(_GROUP):
            deltas[first + i] = source[at + i]
        return at + _GROUP
    following = at + 2 * bits
    for i in range(_GROUP):
        value = 0
        if bits == 1:
            value = (source[at + i // 8] >> (i % 8)) & 1
        elif bits > 1:
            of_byte = 8 // bits
            value = (source[at + i // of_byte] >> (8 - bits - bits * (i % of_byte))) & ((1 << bits) - 1)
        if bits and value == (1 << bits) - 1:
            value = source[following]
            following += 1
        deltas[first + i] = value
    return following


@inner_kernel
def _add_deltas(deltas: Bytes, last: Bytes, channels: Bytes, rows: Bytes) -> bool:
    """Fill ``rows`` (size, stride) with the sums of the deltas; return False for an unknown channel.

    Parameters
    ----------
    deltas : (stride, size or more).
    last : (stride,) the row before the first one, replaced by the last one.
    channels : (stride // 4,) the kind of deltas of each four bytes: 0 bytes, 1 words of two bytes, 2 exclusive or.
    """
    size, stride = rows.shape
    for k in range(0, stride, 4):
        kind, turn = channels[k // 4] & 3, channels[k // 4] >> 4
        if kind == 3:
            return False
        for i in range(size):
            if kind == 0:
                for byte in range(k, k + 4):
                    delta = deltas[byte, i]
                    last[byte] = (last[byte] + ((delta >> 1) ^ -(delta & 1))) & 255
            elif kind == 1:
                for byte in range(k, k + 4, 2):
                    delta = deltas[byte, i] | deltas[byte + 1, i] << 8
                    value = (last[byte] | last[byte + 1] << 8) + ((delta >> 1) ^ -(delta & 1))
                    last[byte], last[byte + 1] = value & 255, (value >> 8) & 255
            else:
                word = np.uint64(0)
                for byte in range(4):
                    word |= np.uint64(deltas[k + byte, i]) << np.uint64(8 * byte)
                word = (word >> np.uint64(turn) | word << np.uint64(32 - turn)) & np.uint64(0xFFFFFFFF)
                for byte in range(4):
                    last[k + byte] ^= np.uint8((word >> np.uint64(8 * byte)) & np.uint64(255))
            for byte in range(k, k + 4):
                rows[i, byte] = last[byte]
    return True
