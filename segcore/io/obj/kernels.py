"""Compiled kernels that parse the lines of OBJ files."""

from typing import NamedTuple

from segcore.arrays import BoolArray, FloatArray, IntArray, LongArray
from segcore.io.text.number_kernels import decimal_number, whole_number
from segcore.io.text.word_kernels import SPACE, Bytes, Lines
from segcore.jit.decorators import inner_kernel, kernel

_MINUS, _SLASH, _ZERO, _NINE = 45, 47, 48, 57


class FaceLines(NamedTuple):
    """The lines that are faces."""

    lines: LongArray  # (N,)
    vertices_before: IntArray  # (N,) the number of vertices before each line, from which negative indices count back
    vertex_count: int  # of the file


@kernel
def parse_vertex_lines(text: Lines, lines: LongArray, vertices: FloatArray, unread: BoolArray) -> int:
    """Fill ``vertices`` (N, 3) with the first three numbers after the keyword of each of ``lines`` (N,).

    Returns
    -------
    The number of lines that are marked in ``unread`` (N,), because one of their words could not be parsed.
    """
    characters, start, line_start = text
    count = 0
    for i in range(len(lines)):
        first, last = line_start[lines[i]] + 1, line_start[lines[i] + 1]
        unread[i] = False
        for word in range(first, last):
            is_read, value = decimal_number(characters, start[word])
            if word - first < 3:
                vertices[i, word - first] = value
            unread[i] |= not is_read
        count += unread[i]
    return count


@kernel
def parse_face_lines(text: Lines, faces: FaceLines, corners: IntArray) -> int:
    """Fill ``corners`` (C,) with the vertices, counted from 0, of corners such as ``7``, ``-1``, ``7/8`` or ``7//9``.

    Returns
    -------
    The first word that is not a corner of an existing vertex, or -1.
    """
    characters, start, line_start = text
    lines, vertices_before, vertex_count = faces
    at = 0
    for i in range(len(lines)):
        for word in range(line_start[lines[i]] + 1, line_start[lines[i] + 1]):
            end, index = whole_number(characters, start[word])
            if end < 0 or not _is_suffix(characters, end):
                return word
            vertex = index + vertices_before[i] if index < 0 else index - 1
            if vertex < 0 or vertex >= vertex_count:
                return word
            corners[at] = vertex
            at += 1
    return -1


@kernel
def parse_corner_picks(text: Lines, lines: LongArray, picks: LongArray) -> None:
    """Fill ``picks`` (C, 2) with the numbers after the first and second slash of the corners; 0 if there is none."""
    characters, start, line_start = text
    corner = 0
    for i in range(len(lines)):
        for word in range(line_start[lines[i]] + 1, line_start[lines[i] + 1]):
            at, place = start[word], 0
            picks[corner, 0] = picks[corner, 1] = 0
            while at + 1 < len(characters) and characters[at] > SPACE:
                if characters[at] == _SLASH and place < 2:
                    end, index = whole_number(characters, at + 1)
                    picks[corner, place] = index if end >= 0 else 0
                    place += 1
                at += 1
            corner += 1


@inner_kernel
def _is_suffix(text: Bytes, at: int) -> bool:
    """Whether the rest of a word is at most two numbers, each after a slash and possibly empty."""
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
