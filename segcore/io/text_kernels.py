"""Compiled kernels that find words in text and turn them into numbers. Arrays in, arrays out."""

from fractions import Fraction
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from segcore.arrays import BoolArray, FloatArray, IntArray, LongArray

Bytes = NDArray[np.uint8]
Offsets = NDArray[np.signedinteger[Any]]

_SPACE = np.uint8(32)  # this byte and all below it separate words
_TAB, _NEWLINE, _CARRIAGE_RETURN = np.uint8(9), np.uint8(10), np.uint8(13)
_BLOCK = 255
_PLUS, _MINUS, _POINT, _SLASH, _ZERO, _NINE = 43, 45, 46, 47, 48, 57
_UPPER_E, _LOWER_E = 69, 101
_DIGITS = 18  # that int64 holds, whatever they are
_EXACT_POWER = 22  # 10**22 is the largest power of ten that float64 holds exactly
_LARGEST_POWER = 270  # beyond that, products might leave the range of float64
_SPLIT = 134217729.0  # 2**27 + 1, which cuts a float64 in two halves
_DOUBT = 2.0**-98  # relative error of a product of two double-doubles, with some to spare

_POWERS = [Fraction(10) ** k for k in range(-_LARGEST_POWER, _LARGEST_POWER + 1)]
_POWER = np.array([float(power) for power in _POWERS])
_POWER_REST = np.array([float(power - Fraction(float(power))) for power in _POWERS])


@njit(cache=True)
def has_controls(text: Bytes) -> bool:
    """Whether there are control characters in a text that are no white space."""
    found = np.uint8(0)
    for byte in text:
        found = np.uint8(found | np.uint8((byte < _TAB) | ((byte > _CARRIAGE_RETURN) & (byte < _SPACE))))
    return found != 0


@njit(cache=True)
def count_words(text: Bytes) -> tuple[int, int]:
    """The number of words, and of newlines.

    Blocks are so short that their counts fit in a byte: then the processor counts many bytes at a time.
    """
    words, newlines = int(len(text) > 0 and text[0] > _SPACE), int(len(text) > 0 and text[0] == _NEWLINE)
    for first in range(1, len(text), _BLOCK):
        block, before = text[first : first + _BLOCK], text[first - 1 : first - 1 + _BLOCK]
        starts, ends = np.uint8(0), np.uint8(0)
        for i in range(len(block)):
            starts = np.uint8(starts + np.uint8((block[i] > _SPACE) & (before[i] <= _SPACE)))
            ends = np.uint8(ends + np.uint8(block[i] == _NEWLINE))
        words += int(starts)
        newlines += int(ends)
    return words, newlines


@njit(cache=True)
def find_word_starts(text: Bytes, begin: int, start: Offsets, line_start: Offsets) -> int:
    """Fill the offset of every word, and in (L + 1,) or more the first word of every line that has one, then W.

    Returns
    -------
    L, the number of lines that have a word.
    """
    at, words, lines = begin, 0, 0
    is_new_line = True
    while at < len(text):
        if text[at] <= _SPACE:
            is_new_line |= text[at] == _NEWLINE
            at += 1
            continue
        if is_new_line:
            line_start[lines] = words
            lines += 1
            is_new_line = False
        start[words] = at
        words += 1
        while at < len(text) and text[at] > _SPACE:
            at += 1
    line_start[lines] = words
    return lines


@njit(cache=True)
def find_lines_with(text: Bytes, start: Offsets, line_start: Offsets, keyword: Bytes, found: BoolArray) -> None:
    """Mark in ``found`` (L,) the lines whose first word is ``keyword``."""
    for i in range(len(found)):
        at = start[line_start[i]]
        end = at + len(keyword)
        found[i] = end <= len(text) and (end == len(text) or text[end] <= _SPACE)
        for k in range(len(keyword)):
            found[i] = found[i] and text[at + k] == keyword[k]


@njit(cache=True)
def parse_integers(text: Bytes, start: Offsets, values: LongArray) -> bool:
    """Fill ``values`` with the whole numbers that begin at ``start``; False where a word is no such number."""
    for i in range(len(start)):
        end, value = _integer(text, start[i])
        if end < 0 or (end < len(text) and text[end] > _SPACE):
            return False
        values[i] = value
    return True


@njit(cache=True)
def parse_floats(text: Bytes, start: Offsets, values: FloatArray, unread: BoolArray) -> int:
    """Fill ``values`` with the nearest floats to the decimal numbers that begin at ``start``.

    Returns
    -------
    How many could not be read here, as they are no plain numbers, very long or very near the middle between two
    floats; these are marked in ``unread``.
    """
    count = 0
    for i in range(len(start)):
        is_read, value = _float(text, start[i])
        values[i] = value
        unread[i] = not is_read
        count += not is_read
    return count


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
            is_read, value = _float(text, start[word])
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
            end, index = _integer(text, start[word])
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
            while at + 1 < len(text) and text[at] > _SPACE:
                if text[at] == _SLASH and place < 2:
                    end, index = _integer(text, at + 1)
                    picks[corner, place] = index if end >= 0 else 0
                    place += 1
                at += 1
            corner += 1


@njit(cache=True)
def _is_suffix(text: Bytes, at: int) -> bool:
    """Whether at most two numbers, each after a slash and perhaps empty, go to the end of the word."""
    slashes = 0
    while at < len(text) and text[at] > _SPACE:
        if text[at] != _SLASH or slashes == 2:
            return False
        slashes += 1
        at += 1
        if at < len(text) and text[at] == _MINUS:
            at += 1
        while at < len(text) and _ZERO <= text[at] <= _NINE:
            at += 1
    return True


@njit(cache=True)
def _integer(text: Bytes, at: int) -> tuple[int, int]:
    """Where a whole number of at most 18 digits ends, or -1, and the number."""
    negative = text[at] == _MINUS
    if negative or text[at] == _PLUS:
        at += 1
    first, value = at, 0
    while at < len(text) and _ZERO <= text[at] <= _NINE:
        if at - first == _DIGITS:
            return -1, 0
        value = 10 * value + (text[at] - _ZERO)
        at += 1
    if at == first:
        return -1, 0
    return at, -value if negative else value


@njit(cache=True)
def _float(text: Bytes, at: int) -> tuple[bool, float]:
    """Whether a word is a decimal number that is read here, and the nearest float to it."""
    negative = text[at] == _MINUS
    if negative or text[at] == _PLUS:
        at += 1
    mantissa, digits, significant, power = 0, 0, 0, 0
    after_point = False
    while at < len(text):
        if text[at] == _POINT and not after_point:
            after_point = True
        elif _ZERO <= text[at] <= _NINE:
            digits += 1
            mantissa = 10 * mantissa + (text[at] - _ZERO)
            significant += significant > 0 or mantissa > 0
            power -= after_point
            if significant > _DIGITS:
                return False, 0.0
        else:
            break
        at += 1
    if digits == 0:
        return False, 0.0
    if at < len(text) and (text[at] == _LOWER_E or text[at] == _UPPER_E):
        at, exponent = _integer(text, at + 1) if at + 1 < len(text) else (-1, 0)
        if at < 0 or abs(exponent) > 1000:
            return False, 0.0
        power += exponent
    if at < len(text) and text[at] > _SPACE:
        return False, 0.0
    is_read, value = _scaled(mantissa, power)
    return is_read, -value if negative else value


@njit(cache=True)
def _scaled(mantissa: int, power: int) -> tuple[bool, float]:
    """The nearest float to mantissa * 10**power, where that is beyond doubt.

    Small numbers by one rounded operation (Clinger, How to read floating point numbers accurately, 1990), others as
    the product of two double-doubles (Dekker, A floating-point technique for extending the available precision, 1971).
    """
    if mantissa == 0:
        return True, 0.0
    high = float(mantissa)
    if mantissa < 2**53 and -_EXACT_POWER <= power <= _EXACT_POWER:
        factor = _POWER[_LARGEST_POWER + abs(power)]
        return True, high * factor if power >= 0 else high / factor
    if abs(power) > _LARGEST_POWER:
        return False, 0.0
    low = float(mantissa - np.int64(high))
    factor, rest = _POWER[_LARGEST_POWER + power], _POWER_REST[_LARGEST_POWER + power]
    product = high * factor
    tail = _product_error(high, factor, product) + (high * rest + low * factor)
    value = product + tail
    tail -= value - product
    doubt = value * _DOUBT
    return value + (tail + doubt) == value and value + (tail - doubt) == value, value


@njit(cache=True)
def _product_error(a: float, b: float, product: float) -> float:
    """a * b - product, exactly."""
    a_high = a * _SPLIT - (a * _SPLIT - a)
    b_high = b * _SPLIT - (b * _SPLIT - b)
    a_low, b_low = a - a_high, b - b_high
    return ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low
