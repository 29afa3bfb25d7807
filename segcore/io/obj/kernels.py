"""Compiled kernels for the lines of OBJ files. Arrays in, arrays out."""

from numba import njit

from segcore.arrays import BoolArray, FloatArray, IntArray, LongArray
from segcore.io.text.number_kernels import decimal_number, whole_number
from segcore.io.text.word_kernels import SPACE, Bytes, Offsets

_MINUS, _SLASH, _ZERO, _NINE = 45, 47, 48, 57


@njit(cache=True)
def parse_vertex_lines(
    text: Bytes, start: Offsets, line_start: Offsets, lines: LongArray, vertices: FloatArray, unread: BoolArray
) -> int:
    """Fill ``vertices`` (N, 3) with the first numbers after the first word of each line; the others are read too.

    Returns
    -------
    How many lines have a word that could not be read here; they are marked in ``unread``, (N,).
    """
    count = 0
    for i in range(len(lines)):
        first, last = line_start[lines[i]] + 1, line_start[lines[i] + 1]
        unread[i] = False
        for word in range(first, last):
            is_read, value = decimal_number(text, start[word])
            if word - first < 3:
                vertices[i, word - first] = value
            unread[i] |= not is_read
        count += unread[i]
    return count


@njit(cache=True)
def parse_face_lines(
    text: Bytes,
    start: Offsets,
    line_start: Offsets,
    lines: LongArray,
    before: IntArray,
    vertex_count: int,
    corners: IntArray,
) -> int:
    """Fill ``corners`` with the vertices, counted from 0, of corners such as ``7``, ``-1``, ``7/8`` or ``7//9``.

    Parameters
    ----------
    before : (N,) how many vertices come before each line; negative indices count back from there.

    Returns
    -------
    The first word that is no corner or names no vertex, or -1.
    """
    at = 0
    for i in range(len(lines)):
        for word in range(line_start[lines[i]] + 1, line_start[lines[i] + 1]):
            end, index = whole_number(text, start[word])
            if end < 0 or not _is_suffix(text, end):
                return word
            vertex = index + before[i] if index < 0 else index - 1
            if vertex < 0 or vertex >= vertex_count:
                return word
            corners[at] = vertex
            at += 1
    return -1


@njit(cache=True)
def parse_corner_picks(text: Bytes, start: Offsets, line_start: Offsets, lines: LongArray, picks: LongArray) -> None:
    """Fill ``picks`` (C, 2) with the numbers after the first and the second slash of corners; 0 where there is none."""
    corner = 0
    for i in range(len(lines)):
        for word in range(line_start[lines[i]] + 1, line_start[lines[i] + 1]):
            at, place = start[word], 0
            picks[corner, 0] = picks[corner, 1] = 0
            while at + 1 < len(text) and text[at] > SPACE:
                if text[at] == _SLASH and place < 2:
                    end, index = whole_number(text, at + 1)
                    picks[corner, place] = index if end >= 0 else 0
                    place += 1
                at += 1
            corner += 1


@njit(cache=True)
def _is_suffix(text: Bytes, at: int) -> bool:
    """Whether at most two numbers, each after a slash and perhaps empty, go to the end of the word."""
    slashes = 0
    while at < len(text) and text[at] > SPACE:
        if text[at] != _SLASH or slashes == 2:
            return False
        slashes += 1
        at += 1
        if at < len(text) and text[at] == _MINUS:
            at += 1
        while at < len(text) and _ZERO <= text[at] <= _NINE:
            at += 1
    return True
